#include "daemon/live/cluster/cluster_names.h"

#include "daemon/messages/topic.h"

namespace rayloc {

std::string subject_token(std::string_view name) {
  std::string token;
  for (const char c : topic_component(name)) {
    token += c == '.' ? std::string("%2E") : std::string(1, c);
  }
  return token;
}

std::string token_name(std::string_view token) { return decoded_component(token); }

std::string_view last_token(std::string_view subject) {
  return subject.substr(subject.rfind('.') + 1);  // npos + 1 is 0
}

std::string csi_stream(std::string_view site) { return "CSI_" + subject_token(site); }

std::string csi_subjects(std::string_view site) {
  return "rayloc.v1.csi." + subject_token(site) + ".>";
}

std::string csi_subject(std::string_view site, std::string_view node) {
  return "rayloc.v1.csi." + subject_token(site) + "." + subject_token(node);
}

std::string owner_subject(std::string_view site) {
  return "rayloc.v1.csi." + subject_token(site) + "._owner";
}

std::string fill_prefix(std::string_view site) {
  return "rayloc.v1.fill." + subject_token(site) + ".";
}

std::string fill_subject(std::string_view site, std::string_view node) {
  return fill_prefix(site) + subject_token(node);
}

std::string live_subjects(std::string_view site) {
  return "rayloc.v1.live." + subject_token(site) + ".>";
}

std::string resend_subject(std::string_view node) {
  return "rayloc.v1.resend." + subject_token(node);
}

std::string output_subject(std::string_view site) { return "rayloc.v1.out." + subject_token(site); }

std::string output_again_subject(std::string_view site) {
  return "rayloc.v1.outlive." + subject_token(site);
}

std::string claim_subject(std::string_view site) {
  return "rayloc.v1.claim." + subject_token(site);
}

std::string worker_subject(std::string_view worker) {
  return "rayloc.v1.worker." + subject_token(worker);
}

std::string drain_subject(std::string_view worker) {
  return "rayloc.v1.drain." + subject_token(worker);
}

}  // namespace rayloc
