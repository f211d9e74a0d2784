// What subjects and streams of a cluster are called. Names of sites, nodes and workers are any
// text; a token of a subject may hold neither '.', '*', '>' nor blanks.
#pragma once

#include <string>
#include <string_view>

namespace rayloc {

// As in topics (daemon/publish/topic.h), and '.' as "%2E" too. REQUIRES: not empty.
std::string subject_token(std::string_view name);
// The name that such a token stands for.
std::string token_name(std::string_view token);
// The last token of a subject; all of it when it has one.
std::string_view last_token(std::string_view subject);

// What capture nodes hear, and what the owner says of it, in one stream for each site.
std::string csi_stream(std::string_view site);
std::string csi_subjects(std::string_view site);
std::string csi_subject(std::string_view site, std::string_view node);
// What the owner of the site writes into it; no node is called so.
std::string owner_subject(std::string_view site);
// Told again once it is stored.
std::string live_subjects(std::string_view site);

// Batches that marks of gaps stand for; all sites share a stream.
inline constexpr std::string_view kFillStream = "FILL";
inline constexpr std::string_view kFillSubjects = "rayloc.v1.fill.>";
std::string fill_subject(std::string_view site, std::string_view node);
std::string fill_prefix(std::string_view site);  // of those of all its nodes

// To a node: v1::ResendRequest.
std::string resend_subject(std::string_view node);

// What a site's owner says; all sites share a stream.
inline constexpr std::string_view kOutputStream = "OUT";
inline constexpr std::string_view kOutputSubjects = "rayloc.v1.out.>";
inline constexpr std::string_view kOutputAgain = "rayloc.v1.outlive.>";
std::string output_subject(std::string_view site);
std::string output_again_subject(std::string_view site);

// Who owns a site: v1::SiteClaim, the last of each subject.
inline constexpr std::string_view kClaimStream = "CLAIMS";
inline constexpr std::string_view kClaimSubjects = "rayloc.v1.claim.>";
inline constexpr std::string_view kClaimsAgain = "rayloc.v1.claimed.>";
std::string claim_subject(std::string_view site);

// A worker says that it is alive: v1::WorkerState.
inline constexpr std::string_view kWorkerSubjects = "rayloc.v1.worker.>";
std::string worker_subject(std::string_view worker);
// To a worker: v1::DrainRequest.
std::string drain_subject(std::string_view worker);

}  // namespace rayloc
