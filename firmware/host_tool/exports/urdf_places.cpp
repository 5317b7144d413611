// SPDX-License-Identifier: MIT
#include "firmware/host_tool/exports/urdf_places.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "firmware/formats/text.hpp"
#include "firmware/linuxcnc/roll_pitch_yaw.hpp"

namespace armsig::tool {
namespace {

constexpr std::string_view kXmlBlanks = " \t\r\n";

// The end of what begins at `begin` and ends with `closing`.
std::size_t behind(std::string_view text, std::size_t begin, std::string_view closing) {
  const std::size_t at = text.find(closing, begin);
  return at == std::string_view::npos ? text.size() : at + closing.size();
}

// The end of the tag that begins at `begin`: a > outside of quotes.
std::size_t end_of_tag(std::string_view text, std::size_t begin) {
  char quote = 0;
  for (std::size_t at = begin; at < text.size(); ++at) {
    const char c = text[at];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      return at + 1;
    }
  }
  return text.size();
}

struct Tag {
  enum class Kind { kNone, kStart, kEmpty, kEnd } kind = Kind::kNone;
  std::string_view name;
  Bytes bytes;
};

// The next tag from `at` on; of kind kNone at the end of the text.
Tag next_tag(std::string_view text, std::size_t at) {
  for (;;) {
    at = std::min(text.find('<', at), text.size());
    if (at == text.size()) return {Tag::Kind::kNone, {}, {at, at}};
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<!--")) {
      at = behind(text, at + 4, "-->");
    } else if (rest.starts_with("<![CDATA[")) {
      at = behind(text, at, "]]>");
    } else if (rest.starts_with("<?")) {
      at = behind(text, at, "?>");
    } else if (rest.starts_with("<!")) {
      at = end_of_tag(text, at);
    } else {
      break;
    }
  }
  const std::size_t end = end_of_tag(text, at);
  const std::string_view tag = text.substr(at, end - at);
  const bool closes = tag.starts_with("</");
  const std::size_t begin = closes ? 2 : 1;
  const std::string_view name = tag.substr(begin, tag.find_first_of(" \t\r\n/>", begin) - begin);
  const Tag::Kind kind = closes                ? Tag::Kind::kEnd
                         : tag.ends_with("/>") ? Tag::Kind::kEmpty
                                               : Tag::Kind::kStart;
  return {kind, name, {at, end}};
}

std::string triple(double x, double y, double z) {
  return fmt::format("{} {} {}", number_text(x), number_text(y), number_text(z));
}

struct OriginTexts {
  std::string xyz;
  std::string rpy;
};

OriginTexts texts_of(const Pose& X) {
  const RollPitchYaw angles = roll_pitch_yaw(X.R);
  return {triple(X.p.x(), X.p.y(), X.p.z()),
          triple(angles.roll_rad, angles.pitch_rad, angles.yaw_rad)};
}

// Between its quotes, the value of the attribute `name` of a tag.
std::optional<Bytes> value_of(std::string_view tag, std::string_view name) {
  std::size_t at = tag.find_first_of(kXmlBlanks);
  while (at < tag.size()) {
    at = std::min(tag.find_first_not_of(kXmlBlanks, at), tag.size());
    const std::size_t name_end = std::min(tag.find_first_of(" \t\r\n=/>", at), tag.size());
    const std::string_view found = tag.substr(at, name_end - at);
    const std::size_t opening = tag.find_first_of("\"'", name_end);
    if (found.empty() || opening == std::string_view::npos) return std::nullopt;
    const std::size_t closing = std::min(tag.find(tag[opening], opening + 1), tag.size());
    if (found == name) return Bytes{opening + 1, closing};
    at = closing + 1;
  }
  return std::nullopt;
}

void set_value(std::string& tag, std::string_view name, const std::string& value) {
  if (const auto bytes = value_of(tag, name)) {
    tag.replace(bytes->begin, bytes->end - bytes->begin, value);
    return;
  }
  constexpr std::string_view kStart = "<origin";
  tag.insert(kStart.size(), fmt::format(" {}=\"{}\"", name, value));
}

}  // namespace

std::vector<JointPlace> joint_places(std::string_view text) {
  std::vector<JointPlace> places;
  std::size_t depth = 0;
  bool in_joint = false;
  for (Tag tag = next_tag(text, 0); tag.kind != Tag::Kind::kNone;
       tag = next_tag(text, tag.bytes.end)) {
    if (tag.kind == Tag::Kind::kEnd) {
      if (depth > 0) --depth;
      if (depth == 1) in_joint = false;
      continue;
    }
    if (depth == 1 && tag.name == "joint") {
      places.push_back({tag.bytes, {}});
      in_joint = tag.kind == Tag::Kind::kStart;
    } else if (depth == 2 && in_joint && tag.name == "origin" && !places.back().origin) {
      places.back().origin = tag.bytes;
    }
    if (tag.kind == Tag::Kind::kStart) ++depth;
  }
  return places;
}

std::size_t end_of_root_tag(std::string_view text) { return next_tag(text, 0).bytes.end; }

std::string origin_element(const Pose& X) {
  const OriginTexts texts = texts_of(X);
  return fmt::format(R"(<origin xyz="{}" rpy="{}"/>)", texts.xyz, texts.rpy);
}

std::string with_origin(std::string_view tag, const Pose& X) {
  const OriginTexts texts = texts_of(X);
  std::string changed(tag);
  // What is absent is put first: rpy before xyz, so that xyz comes to stand before it.
  set_value(changed, "rpy", texts.rpy);
  set_value(changed, "xyz", texts.xyz);
  return changed;
}

}  // namespace armsig::tool
