// Names of the subjects and streams of a cluster. Names of sites, nodes and workers
// are any text; a token of a subject may contain neither '.', '*', '>' nor blanks.
#pragma once

#include <string>
#include <string_view>

namespace rayloc {

// Escapes as in topics (daemon/messages/topic.h), and '.' as "%2E" too. REQUIRES: not empty.
std::string subject_token(std::string_view name);
// Returns the name that such a token encodes.
std::string token_name(std::string_view token);
// Returns the last token of a subject; the whole subject when it has one.
std::string_view last_token(std::string_view subject);

// Batches of capture nodes, and the owner's records about them, in one stream for each site.
std::string csi_stream(std::string_view site);
std::string csi_subjects(std::string_view site);
std::string csi_subject(std::string_view site, std::string_view node);
// Records of the owner of the site in its stream; no node has this name.
std::string owner_subject(std::string_view site);
// Republication of stored messages.
std::string live_subjects(std::string_view site);

// Batches replaced by gap marks; all sites share a stream.
inline constexpr std::string_view kFillStream = "FILL";
inline constexpr std::string_view kFillSubjects = "rayloc.v1.fill.>";
std::string fill_subject(std::string_view site, std::string_view node);
std::string fill_prefix(std::string_view site);  // prefix for all its nodes

// Requests to a node: v1::ResendRequest.
std::string resend_subject(std::string_view node);

// Results of a site's owner; all sites share a stream.
inline constexpr std::string_view kOutputStream = "OUT";
inline constexpr std::string_view kOutputSubjects = "rayloc.v1.out.>";
inline constexpr std::string_view kOutputAgain = "rayloc.v1.outlive.>";
std::string output_subject(std::string_view site);
std::string output_again_subject(std::string_view site);

// Owner of a site: v1::SiteClaim, the last of each subject.
inline constexpr std::string_view kClaimStream = "CLAIMS";
inline constexpr std::string_view kClaimSubjects = "rayloc.v1.claim.>";
inline constexpr std::string_view kClaimsAgain = "rayloc.v1.claimed.>";
std::string claim_subject(std::string_view site);

// Report of a worker that it is alive: v1::WorkerState.
inline constexpr std::string_view kWorkerSubjects = "rayloc.v1.worker.>";
std::string worker_subject(std::string_view worker);
// Requests to a worker: v1::DrainRequest.
std::string drain_subject(std::string_view worker);

}  // namespace rayloc
