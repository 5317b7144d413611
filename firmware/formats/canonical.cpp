// SPDX-License-Identifier: MIT
#include "firmware/formats/canonical.hpp"

#include <algorithm>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "core/base/crc32.hpp"
#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/yaml_map.hpp"

namespace armsig::tool {
namespace {

void append(std::string& out, const YamlNode& node, std::string_view omitted_key) {
  switch (node.kind) {
    case YamlNode::Kind::kEmpty:
      out += '~';
      return;
    case YamlNode::Kind::kScalar: {
      const auto number = node.plain ? parse_number(node.text) : std::nullopt;
      out += number ? fmt::format("{:.17g}", *number) : node.text;
      return;
    }
    case YamlNode::Kind::kSequence:
      out += '[';
      for (const YamlNode& item : node.items) {
        append(out, item, {});
        out += ';';
      }
      out += ']';
      return;
    case YamlNode::Kind::kMap: {
      std::vector<std::size_t> order(node.keys.size());
      for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
      std::ranges::sort(order, {},
                        [&](std::size_t i) -> const std::string& { return node.keys[i].text; });
      out += '{';
      for (const std::size_t i : order) {
        if (!omitted_key.empty() && node.keys[i].text == omitted_key) continue;
        out += node.keys[i].text;
        out += ':';
        append(out, node.items[i], {});
        out += ';';
      }
      out += '}';
      return;
    }
  }
}

std::string crc_text(const YamlNode& document) {
  return fmt::format("0x{:08X}", content_crc32(document));
}

}  // namespace

std::string canonical_text(const YamlNode& document) {
  std::string text;
  append(text, document, kCrcKey);
  return text;
}

std::uint32_t content_crc32(const YamlNode& document) {
  const std::string text = canonical_text(document);
  return crc32(std::as_bytes(std::span(text)));
}

Read<std::string> sealed(std::string body) {
  ARMSIG_TRY(document, parse_yaml(body));
  body += fmt::format("{}: {}\n", kCrcKey, crc_text(document));
  return body;
}

Read<void> check_seal(const YamlNode& document) {
  const YamlNode* crc = document.find(kCrcKey);
  if (crc == nullptr) {
    return problem_at(document, "the file has no key \"crc32\"",
                      "the file as armsig wrote it, with its crc32");
  }
  const std::string computed = crc_text(document);
  if (crc->text == computed) return {};
  return problem_at(
      *crc,
      fmt::format("the content does not match its crc32 (it has {}, the file says {})", computed,
                  in_quotes(crc->text)),
      "the file as armsig wrote it; it was changed or damaged");
}

}  // namespace armsig::tool
