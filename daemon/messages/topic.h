// Topics: the first frame of every published message (proto/rayloc/v1/envelope.proto).
//
// A topic ends in '/', because subscriptions match by prefix and "ap1" would match "ap10". Bytes of
// a component other than letters, digits and -._:~ are written as '%' and two hex digits, so that a
// name can neither end a component nor split a line.
#pragma once

#include <string>
#include <string_view>

namespace rayloc::v1 {
class Target;
}  // namespace rayloc::v1

namespace rayloc {

struct Target;

// Prefix of heartbeat topics.
inline constexpr const char* kHeartbeatTopics = "v1/heartbeat/";

// "v1/CLASS/SITE/" or "v1/CLASS/SITE/LEAF/". REQUIRES: site is not empty.
std::string make_topic(std::string_view topic_class, std::string_view site);
std::string make_topic(std::string_view topic_class, std::string_view site, std::string_view leaf);

// "v1/compared/SITE/METHOD/TARGET/", for an estimate of a compared method.
std::string compared_topic(std::string_view site, std::string_view method, std::string_view target);

// "v1/CLASS/SITE/" of any topic made by make_topic; the topic itself when it is shorter.
std::string_view topic_prefix(std::string_view topic);

// "SITE" of any topic made by make_topic, in its escaped form; empty if it has none.
std::string_view topic_site(std::string_view topic);

// The component of a site in a topic: its name, escaped.
std::string topic_component(std::string_view name);
// The name that such a component denotes.
std::string decoded_component(std::string_view component);

// The <target> of a topic: mac, else hashed mac, else "person-N"; empty if the target has none.
std::string target_component(const v1::Target& target);
std::string target_component(const Target& target);

}  // namespace rayloc
