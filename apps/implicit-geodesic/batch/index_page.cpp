#include "batch/index_page.h"

#include <fmt/core.h>
#include <igeo/results/detail/web_text.h>
#include <igeo/results/view_page.h>

#include <filesystem>
#include <fstream>

namespace fs = std::filesystem;

namespace {

constexpr const char* kPage = R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="{{creator}}">
<title>{{title}}</title>
<style>
body { margin: 1rem; font: 14px/1.45 system-ui, sans-serif; color: #1b1d21; }
h1 { font-size: 18px; overflow-wrap: anywhere; }
ul { display: grid; grid-template-columns: repeat(auto-fill, minmax(15rem, 1fr)); gap: 12px; padding: 0; list-style: none; }
li { border: 1px solid #dcdfe4; border-radius: 6px; padding: 8px; overflow-wrap: anywhere; }
li a { color: inherit; }
li p { margin: 4px 0 0; }
img { display: block; width: 100%; aspect-ratio: 4 / 3; object-fit: contain; }
.failed { border-color: #b3261e; }
small { color: #555b66; }
</style>
</head>
<body>
<h1>{{title}}</h1>
<p>{{counts}}</p>
<ul>
{{tiles}}</ul>
</body>
</html>
)";

/// The picture in a page of --view, as an address; empty if there is none.
std::string pictureIn(const std::string& page) {
    constexpr std::size_t kMost = 4u << 20;
    std::ifstream in(page, std::ios::binary);
    std::string head(kMost, '\0');
    in.read(head.data(), std::streamsize(head.size()));
    head.resize(std::size_t(in.gcount()));
    return igeo::stillOfPage(head);
}

/// A relative address of a file; reserved characters are written as %xx.
std::string linkTo(const std::string& file, const fs::path& folder) {
    const std::string path = fs::relative(fs::absolute(file), folder).generic_string();
    std::string link;
    for (const char c : path) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                           (c >= '0' && c <= '9') || c == '/' || c == '.' || c == '-' || c == '_';
        link += plain ? std::string(1, c) : fmt::format("%{:02X}", unsigned((unsigned char)(c)));
    }
    return "./" + link;
}

std::string tile(const BatchJob& job, const JobRecord& record, const fs::path& folder) {
    const RunOptions& o = job.options;
    const std::string name = igeo::htmlText(record.name);
    std::string html = fmt::format("<li class=\"{}\">", record.status());
    const bool done = record.done();
    if (done && (!o.view.empty() || !o.image.empty())) {
        const std::string still = o.view.empty() ? "" : pictureIn(o.view);
        html +=
            fmt::format("<a href=\"{}\"><img alt=\"\" src=\"{}\">{}</a>",
                        linkTo(o.view.empty() ? o.image : o.view, folder),
                        still.empty() && !o.image.empty() ? linkTo(o.image, folder) : still, name);
    } else {
        html += name;
    }
    html += fmt::format("<p><small>{}", record.status());
    if (!record.what.empty()) html += ": " + igeo::htmlText(record.what);
    for (const auto& [file, digest] : record.outputs)
        html +=
            fmt::format("<br><a href=\"{}\">{}</a>", linkTo(file, folder), igeo::htmlText(file));
    return html + "</small></p></li>\n";
}

}  // namespace

std::string indexPage(const BatchPlan& plan, const Summary& summary, const std::string& file) {
    const fs::path folder = fs::absolute(file).parent_path();
    std::string tiles, counts;
    for (const JobRecord& record : summary.jobs)
        tiles += tile(plan.jobs[record.index], record, folder);
    for (const char* status : {"done", "unreached", "failed", "waiting"})
        if (const std::size_t n = summary.namesOf(status).size())
            counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", n, status);
    return igeo::filledIn(kPage, {{"title", igeo::htmlText(summary.manifest)},
                                  {"creator", igeo::htmlText(summary.creator)},
                                  {"counts", counts},
                                  {"tiles", tiles}});
}
