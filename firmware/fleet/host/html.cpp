// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/html.hpp"

#include <cstdlib>

#include <fmt/format.h>

namespace armsig::fleet {
namespace {

constexpr std::string_view kStyle =
    ":root{color-scheme:light dark}"
    "body{font:15px/1.45 system-ui,sans-serif;margin:1rem auto;max-width:80rem;padding:0 1rem;"
    "color:#1b1f24;background:#fff}h1{font-size:1.5rem;margin:.2rem 0}h2{font-size:1.1rem;"
    "margin:1.6rem 0 .4rem}div{overflow-x:auto}table{border-collapse:collapse;white-space:nowrap}"
    "th,td{text-align:left;padding:.3rem .9rem .3rem 0;border-bottom:1px solid #d0d7de}"
    "th{position:sticky;top:0;background:#fff}.n{text-align:right;"
    "font-variant-numeric:tabular-nums}.bad{color:#b3261e;font-weight:600}a{color:#0b57d0}"
    // Of a thousand arms only those that are seen are laid out: columns of a given width, and rows
    // in lots that the browser leaves out.
    ".arms,.arms tbody{display:block}.arms tbody{content-visibility:auto;"
    "contain-intrinsic-size:auto 100rem}.arms tr{display:grid;grid-template-columns:"
    "9rem 6.5rem 15.5rem 7.5rem 4rem 10rem 9rem 9rem 6rem}.arms td{white-space:normal;"
    "overflow-wrap:anywhere}"
    // What a narrow window has no room for stands on the page of the arm; a fault gets a line.
    "@media(max-width:1180px){.arms thead{display:block}.arms tr{grid-template-columns:"
    "1fr 5.5rem 7.5rem 4rem 10rem 9rem;border-bottom:1px solid #d0d7de}.arms td{border:0}"
    ".arms :is(th,td):nth-child(n+8),.arms th:nth-child(3),.arms td:nth-child(3):empty"
    "{display:none}.arms td:nth-child(3){grid-column:1/-1;order:1;padding-top:0}}"
    "@media(max-width:700px){.arms th{white-space:normal}.arms tr{grid-template-columns:"
    "1fr 5.5rem 6rem 4rem}.arms :is(th,td):nth-child(n+6){display:none}}"
    "p{overflow-wrap:anywhere}.ends{display:flex;flex-wrap:wrap;gap:0 "
    "1rem;justify-content:space-between;"
    "margin:.2rem "
    "0}.rule{stroke:#d0d7de}.f{white-space:normal}.long{white-space:normal;overflow-wrap:anywhere;"
    "min-width:16rem}"
    "details{margin:.4rem "
    "0}summary{cursor:pointer}svg{max-width:100%;height:auto}polyline{fill:none;stroke:#0b57d0;"
    "stroke-width:1.5}"
    "@media(prefers-color-scheme:dark){body,th{color:#e6e9ed;background:#14171a}"
    "th,td,.arms "
    "tr{border-color:#3a4149}.rule{stroke:#3a4149}a{color:#8ab4f8}.bad{color:#ff8a80}polyline{"
    "stroke:#8ab4f8}}"
    "@media print{body{margin:0;max-width:none;font-size:10pt}th{position:static}"
    "div{overflow:visible}table{white-space:normal}tr,svg{break-inside:avoid}"
    ".arms "
    "tbody{content-visibility:visible}h1,h2{break-after:avoid}thead{display:table-header-group}}";

}  // namespace

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string page_head(std::string_view title) {
  return fmt::format(
      "<!doctype html><html lang=en><meta charset=utf-8>"
      "<meta name=viewport content=\"width=device-width\"><title>{}</title><style>{}</style><main>",
      escaped(title), kStyle);
}

std::string table_head(std::string_view what, std::string_view attributes) {
  return fmt::format("<div role=region tabindex=0 aria-label=\"{}\"><table{}>", escaped(what),
                     attributes);
}

std::string cell(const Cell& text, std::string_view attributes) {
  return fmt::format("<td{}>{}</td>", attributes, escaped(text.value_or("")));
}

std::string decimals(const Cell& number, int count) {
  return number ? fmt::format("{:.{}f}", std::strtod(number->c_str(), nullptr), count) : "";
}

}  // namespace armsig::fleet
