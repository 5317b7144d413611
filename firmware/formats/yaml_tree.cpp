// SPDX-License-Identifier: MIT
#include "firmware/formats/yaml_tree.hpp"

#include <algorithm>
#include <cstddef>
#include <exception>
#include <new>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include "firmware/formats/characters.hpp"
#include "firmware/formats/encoding.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

// More than any of our maps has; keeps the search for equal keys short.
constexpr std::size_t kMostKeys = 256;

// Deeper than any of ours.
constexpr std::size_t kDeepest = 16;
// A signature with the largest covariance has 70,000. yaml-cpp keeps a token for each, and a list
// in brackets whole, before it says a word: what is more is refused before it sees the text.
constexpr std::ptrdiff_t kMostMarks = 250'000;

// Thrown through yaml-cpp, which has no other way to stop.
struct Stop {
  Problem problem;
};

// Builds the tree from yaml-cpp's events; stops it at the first problem.
class TreeBuilder final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
    add(node_at(mark, YamlNode::Kind::kEmpty));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    refuse_anchor(mark, anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_anchor(mark, anchor);
    refuse_tag(mark, tag);
    refuse_unprintable(mark, value);
    YamlNode node = node_at(mark, YamlNode::Kind::kScalar);
    node.plain = tag == "?";
    node.text = value;
    add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    refuse_anchor(mark, anchor);
    refuse_tag(mark, tag);
    open(node_at(mark, YamlNode::Kind::kSequence));
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    refuse_anchor(mark, anchor);
    refuse_tag(mark, tag);
    open(node_at(mark, YamlNode::Kind::kMap));
  }
  void OnMapEnd() override { close(); }

  [[nodiscard]] YamlNode result() && { return std::move(root_); }

 private:
  static YamlNode node_at(const YAML::Mark& mark, YamlNode::Kind kind) {
    YamlNode node;
    node.kind = kind;
    node.line = mark.line + 1;
    node.column = mark.column + 1;
    return node;
  }

  [[noreturn]] static void refuse(int line, int column, std::string what, std::string expected) {
    throw Stop{{{}, line, column, std::move(what), std::move(expected)}};
  }
  // Escapes such as "\r" and "\N" make characters that the bytes of the file do not show.
  static void refuse_unprintable(const YAML::Mark& mark, const std::string& value) {
    const auto bad = first_unprintable(value);
    if (!bad) return;
    const std::string_view rest = std::string_view(value).substr(*bad);
    const std::size_t length = std::max<std::size_t>(first_character(rest).length, 1);
    refuse(
        mark.line + 1, mark.column + 1,
        fmt::format("the character {} in {}", in_quotes(rest.substr(0, length)), in_quotes(value)),
        "printable text on one line");
  }
  static void refuse_anchor(const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (anchor == 0) return;
    refuse(mark.line + 1, mark.column + 1, "a YAML anchor or alias", "the value itself");
  }
  // "?" and "!" are yaml-cpp's marks for plain and quoted scalars without a tag.
  static void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    if (tag.empty() || tag == "?" || tag == "!") return;
    refuse(mark.line + 1, mark.column + 1, "a YAML tag", "a value without a tag");
  }

  void open(YamlNode node) {
    if (open_.size() == kDeepest) {
      refuse(node.line, node.column, "nested too deeply", fmt::format("{} levels", kDeepest));
    }
    open_.push_back(std::move(node));
  }

  void close() {
    YamlNode node = std::move(open_.back());
    open_.pop_back();
    add(std::move(node));
  }

  void add(YamlNode node) {
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    YamlNode& parent = open_.back();
    if (parent.kind == YamlNode::Kind::kMap && parent.keys.size() == parent.items.size()) {
      check_key(parent, node);
      parent.keys.push_back(std::move(node));
    } else {
      parent.items.push_back(std::move(node));
    }
  }

  static void check_key(const YamlNode& map, const YamlNode& key) {
    if (key.kind != YamlNode::Kind::kScalar) {
      refuse(key.line, key.column, "a key that is not text", "a name before the colon");
    }
    if (map.keys.size() == kMostKeys) {
      refuse(key.line, key.column, "too many keys", fmt::format("at most {} in a map", kMostKeys));
    }
    const auto earlier = std::ranges::find(map.keys, key.text, &YamlNode::text);
    if (earlier == map.keys.end()) return;
    refuse(
        key.line, key.column,
        fmt::format("key {} is given twice (first in line {})", in_quotes(key.text), earlier->line),
        "each key once");
  }

  YamlNode root_;
  std::vector<YamlNode> open_;
};

// yaml-cpp takes some bytes for more than they are (0x04 ends its input, 0xFF 0xFE starts UTF-16).
Read<void> check_bytes(std::string_view text) {
  const auto bad = first_bad_byte(text);
  if (!bad) return {};
  const Character character = first_character(text.substr(*bad));
  const std::string_view before = text.substr(0, *bad);
  const auto line = std::ranges::count(before, '\n') + 1;
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
  return problem_at(static_cast<int>(line), static_cast<int>(*bad - line_start + 1),
                    character.length > 1
                        ? "the character " + in_quotes(text.substr(*bad, character.length))
                        : "the byte " + in_quotes(text.substr(*bad, 1)),
                    "UTF-8 text");
}

Read<void> check_size(std::string_view text) {
  const auto is_mark = [](char c) {
    return std::string_view(",:?[]{}\"'!\n").find(c) != std::string_view::npos;
  };
  if (std::ranges::count_if(text, is_mark) <= kMostMarks) return {};
  return problem_at(
      0, 0, "too much in one file",
      fmt::format("at most {} lines, commas, colons, quotes and brackets", kMostMarks));
}

// Of text without a document.
std::string what_it_is(std::string_view text) {
  if (text.empty()) return "the file is empty";
  return text.find('#') == std::string_view::npos ? "the file holds only blank lines"
                                                  : "the file holds only comments";
}

Read<YamlNode> parse_with_yaml_cpp(std::string_view text) {
  std::istringstream stream{std::string(text)};
  YAML::Parser parser(stream);
  TreeBuilder document;
  if (!parser.HandleNextDocument(document)) {
    return problem_at(0, 0, what_it_is(text), "a YAML document");
  }
  TreeBuilder second;
  if (parser.HandleNextDocument(second)) {
    return problem_at(std::move(second).result().line, 0, "a second YAML document",
                      "one document a file");
  }
  return std::move(document).result();
}

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
  if (kind != Kind::kMap) return nullptr;
  const auto found = std::ranges::find(keys, key, &YamlNode::text);
  return found == keys.end() ? nullptr : &items[static_cast<std::size_t>(found - keys.begin())];
}

Read<YamlNode> parse_yaml(std::string_view text) {
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (is_utf16(text)) {
    return problem_at(
        0, 0, "text in UTF-16",
        "UTF-8: save it so, or iconv -f UTF-16 -t UTF-8 (-f UTF-16LE without a mark)");
  }
  std::string with_line_feeds;
  if (has_lone_returns(text)) {
    with_line_feeds = text;
    std::ranges::replace(with_line_feeds, '\r', '\n');
    text = with_line_feeds;
  }
  if (auto small = check_size(text); !small) return std::unexpected(std::move(small).error());
  if (auto clean = check_bytes(text); !clean) return std::unexpected(std::move(clean).error());
  try {
    return parse_with_yaml_cpp(text);
  } catch (const Stop& stop) {
    return std::unexpected(stop.problem);
  } catch (const std::bad_alloc&) {
    throw;  // says nothing of the file
  } catch (const YAML::Exception& fault) {
    // There is no file behind our stream: yaml-cpp says "bad file" of maps in maps in maps ...
    const bool too_deep = fault.msg == YAML::ErrorMsg::BAD_FILE;
    return problem_at(fault.mark.line + 1, fault.mark.column + 1,
                      "not YAML: " + (too_deep ? "nested too deeply" : fault.msg),
                      "a YAML document");
  } catch (const std::exception& fault) {
    return problem_at(0, 0, std::string("not YAML: ") + fault.what(), "a YAML document");
  }
}

std::string_view word_of(YamlNode::Kind kind) {
  switch (kind) {
    case YamlNode::Kind::kEmpty:
      return "nothing";
    case YamlNode::Kind::kScalar:
      return "text";
    case YamlNode::Kind::kSequence:
      return "a list";
    case YamlNode::Kind::kMap:
      return "a map";
  }
  return "nothing";
}

std::string yaml_quoted(std::string_view text) {
  std::string out = "\"";
  while (!text.empty()) {
    const Character character = first_character(text);
    const std::size_t length = std::max<std::size_t>(character.length, 1);
    if (text[0] == '"' || text[0] == '\\') {
      out += '\\';
      out += text[0];
    } else if (character.length == 0) {
      out += "\\uFFFD";  // YAML has no way to write a byte
    } else if (is_printable(character.code)) {
      out += text.substr(0, length);
    } else {
      out += fmt::format("\\U{:08X}", character.code);
    }
    text.remove_prefix(length);
  }
  return out + "\"";
}

}  // namespace armsig::tool
