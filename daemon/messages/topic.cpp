#include "daemon/messages/topic.h"

#include <algorithm>
#include <charconv>
#include <cstdint>

#include "daemon/messages/location.h"
#include "engine/base/check.h"
#include "rayloc/v1/target.pb.h"

namespace rayloc {
namespace {

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
         c == '.' || c == '_' || c == ':' || c == '~';
}

void append_component(std::string& topic, std::string_view component) {
  RAYLOC_CHECK(!component.empty());
  constexpr std::string_view kHex = "0123456789ABCDEF";
  for (const char c : component) {
    if (is_plain(c)) {
      topic += c;
    } else {
      const auto byte = static_cast<unsigned char>(c);
      topic += '%';
      topic += kHex[byte >> 4U];
      topic += kHex[byte & 0xfU];
    }
  }
  topic += '/';
}

std::string person_component(std::uint64_t track) { return "person-" + std::to_string(track); }

}  // namespace

std::string make_topic(std::string_view topic_class, std::string_view site) {
  std::string topic = "v1/";
  append_component(topic, topic_class);
  append_component(topic, site);
  return topic;
}

std::string make_topic(std::string_view topic_class, std::string_view site, std::string_view leaf) {
  std::string topic = make_topic(topic_class, site);
  append_component(topic, leaf);
  return topic;
}

std::string compared_topic(std::string_view site,
                           std::string_view method,
                           std::string_view target) {
  std::string topic = make_topic("compared", site, method);
  append_component(topic, target);
  return topic;
}

std::string_view topic_prefix(std::string_view topic) {
  std::size_t end = 0;
  for (int component = 0; component < 3; ++component) {
    const std::size_t slash = topic.find('/', end);
    if (slash == std::string_view::npos) {
      return topic;
    }
    end = slash + 1;
  }
  return topic.substr(0, end);
}

std::string_view topic_site(std::string_view topic) {
  std::string_view site = topic_prefix(topic);
  constexpr int kComponents = 3;
  if (std::count(site.begin(), site.end(), '/') != kComponents) {
    return {};
  }
  site.remove_suffix(1);
  return site.substr(site.rfind('/') + 1);
}

std::string topic_component(std::string_view name) {
  std::string component;
  append_component(component, name);
  component.pop_back();
  return component;
}

std::string decoded_component(std::string_view component) {
  constexpr int kHexadecimal = 16;
  std::string name;
  for (std::size_t i = 0; i < component.size(); ++i) {
    // An invalid escape is left unchanged: the text comes from the network and is not trusted.
    unsigned character = 0;
    const char* const digits = component.data() + i + 1;
    if (component[i] == '%' && i + 2 < component.size() &&
        std::from_chars(digits, digits + 2, character, kHexadecimal).ptr == digits + 2) {
      name += static_cast<char>(character);
      i += 2;
    } else {
      name += component[i];
    }
  }
  return name;
}

std::string target_component(const v1::Target& target) {
  if (target.has_mac()) {
    return target.mac();
  }
  if (target.has_hashed_mac()) {
    return target.hashed_mac();
  }
  return target.has_track() ? person_component(target.track()) : std::string();
}

std::string target_component(const Target& target) {
  if (!target.address.empty()) {
    return target.address;
  }
  return target.track ? person_component(*target.track) : std::string();
}

}  // namespace rayloc
