#include <igeo/results/view_page.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/io/detail/base64.h>
#include <igeo/results/color_map.h>
#include <igeo/results/detail/page_numbers.h>
#include <igeo/results/detail/view_files.h>
#include <igeo/results/detail/web_text.h>
#include <igeo/results/isolines.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace igeo {

namespace {

// Codes, the same as in drawing.js.
constexpr std::uint32_t kBlocked = 65534, kUnreachedCode = 65535;

/// The HTML before the address of the picture.
constexpr std::string_view kStill =
    R"(<img id="still" alt="A picture of what the page shows" src=")";

/// The cube around all positions of a scene; its sides are divided into 65535 steps.
struct SceneBox {
    Vec3d low{kInfinity, kInfinity, kInfinity}, high = -low;
    double side = 1;

    explicit SceneBox(const ViewScene& scene) {
        for (const Vec3d& p : scene.mesh.position) add(p);
        for (const NamedCurve& line : scene.lines)
            for (const Vec3d& p : line.points) add(p);
        const Vec3d size = high - low;
        const double longest = std::max({size.x, size.y, size.z});
        if (longest > 0) side = longest;
    }
    std::uint32_t step(double x, int axis) const {
        return std::uint32_t(std::lround(65535 * (x - low[axis]) / side));
    }

private:
    void add(const Vec3d& p) {
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(low[axis], p[axis]);
            high[axis] = std::max(high[axis], p[axis]);
        }
    }
};

/// The range of the colors; low > high: no distance is finite.
struct Range {
    double low = kInfinity, high = -kInfinity;

    explicit Range(const ViewScene& scene) {
        for (const double d : scene.mesh.distance)
            if (std::isfinite(d)) low = std::min(low, d), high = std::max(high, d);
        if (scene.range && !empty()) low = (*scene.range)[0], high = (*scene.range)[1];
    }
    bool empty() const { return low > high; }
    std::uint32_t code(double d) const {
        const double share = high > low ? std::clamp((d - low) / (high - low), 0.0, 1.0) : 0;
        return std::uint32_t(std::lround((kBlocked - 1) * share));
    }
};

bool isBlocked(const ViewScene& scene, std::size_t v) {
    return !scene.blocked.empty() && scene.blocked[v];
}

Numbers valueCodes(const ViewScene& scene, const Range& range) {
    Numbers codes;
    for (std::size_t v = 0; v < scene.mesh.position.size(); ++v)
        codes.push_back(isBlocked(scene, v)                     ? kBlocked
                        : std::isfinite(scene.mesh.distance[v]) ? range.code(scene.mesh.distance[v])
                                                                : kUnreachedCode);
    return codes;
}

/// The numbers plus 1; 0: none.
Numbers orZero(const Numbers& numbers) {
    Numbers all;
    for (const std::uint32_t n : numbers) all.push_back(n == ViewScene::kNoNumber ? 0 : n + 1);
    return all;
}

/// Shares of the surface: triangles with an unreached vertex, and with a vertex in an obstacle.
struct Shares {
    double unreached = 0, blocked = 0;

    explicit Shares(const ViewScene& scene) {
        double all = 0;
        for (const auto& [a, b, c] : scene.mesh.triangles) {
            const std::vector<Vec3d>& p = scene.mesh.position;
            const double area = length(cross(p[b] - p[a], p[c] - p[a]));
            all += area;
            if (isBlocked(scene, a) || isBlocked(scene, b) || isBlocked(scene, c))
                blocked += area;
            else
                for (const std::uint32_t v : {a, b, c})
                    if (!std::isfinite(scene.mesh.distance[v])) {
                        unreached += area;
                        break;
                    }
        }
        if (all > 0) unreached /= all, blocked /= all;
    }
};

std::string json(double x) { return std::isfinite(x) ? fmt::format("{}", x) : "null"; }
std::string json(const Vec3d& p) {
    return fmt::format("[{},{},{}]", json(p.x), json(p.y), json(p.z));
}

template <typename Items, typename Text>
std::string list(const Items& items, const Text& text) {
    std::string all;
    for (const auto& item : items) all += (all.empty() ? "" : ",") + text(item);
    return "[" + all + "]";
}

std::string json(const std::vector<std::string>& words) { return list(words, jsonString); }

std::string json(const std::vector<ViewPoint>& points) {
    return list(points, [](const ViewPoint& p) {
        const std::string distance = p.distance ? ",\"distance\":" + json(*p.distance) : "";
        return fmt::format("{{\"name\":{},\"at\":{}{}}}", jsonString(p.name), json(p.position),
                           distance);
    });
}

std::string json(const std::optional<Similarity>& voxels) {
    if (!voxels) return "null";
    std::string rows;
    const Vec3d zero = voxels->indexFromWorld({});
    for (int k = 0; k < 3; ++k) {
        const Vec3d row = voxels->axis[std::size_t(k)] * (1 / voxels->dx);
        rows += fmt::format("{}[{},{},{},{}]", k ? "," : "", json(row.x), json(row.y), json(row.z),
                            json(zero[k]));
    }
    return "[" + rows + "]";
}

/// The sRGB tables of the color maps, in hexadecimal.
std::string mapsJson() {
    constexpr int kColors = 52;  // linear in between, as in color_map.cpp
    std::string maps;
    for (const std::string& name : ColorMap::names()) {
        const ColorMap map(name);
        std::string digits;
        for (int k = 0; k < kColors; ++k) {
            const Vec3d c = srgbFromLinear(map(k / double(kColors - 1)));
            for (int channel = 0; channel < 3; ++channel)
                digits += fmt::format("{:02x}", std::lround(255 * c[channel]));
        }
        maps += fmt::format("{}\"{}\":\"{}\"", maps.empty() ? "" : ",", name, digits);
    }
    return "{" + maps + "}";
}

/// All arrays of a scene, packed side by side.
class Packing {
public:
    void add(const std::string& name, Numbers numbers, bool differences = true) {
        all_.push_back({name, std::move(numbers), differences});
    }
    void addPoints(const std::string& name, const std::vector<Vec3d>& points, const SceneBox& box) {
        for (int axis = 0; axis < 3; ++axis) {
            Numbers steps;
            for (const Vec3d& p : points) steps.push_back(box.step(p[axis], axis));
            add(name + "xyz"[axis], std::move(steps));
        }
    }
    std::map<std::string, std::string> texts() const {
        std::vector<std::string> packs(all_.size());
        parallelFor(packs.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                packs[k] = packed(all_[k].numbers, all_[k].differences);
        });
        std::map<std::string, std::string> named;
        for (std::size_t k = 0; k < packs.size(); ++k) named[all_[k].name] = '"' + packs[k] + '"';
        return named;
    }

private:
    struct Array {
        std::string name;
        Numbers numbers;
        bool differences;
    };
    std::vector<Array> all_;
};

std::map<std::string, std::string> arraysOf(const ViewScene& scene, const SceneBox& box,
                                            const Range& range) {
    Packing packing;
    packing.addPoints("point", scene.mesh.position, box);
    std::vector<Vec3d> onLines;
    for (const NamedCurve& line : scene.lines)
        onLines.insert(onLines.end(), line.points.begin(), line.points.end());
    packing.addPoints("line", onLines, box);
    packing.add("values", valueCodes(scene, range));
    TriangleFans fans(scene.mesh.triangles, scene.mesh.position.size());
    packing.add("middle", std::move(fans.middle));
    packing.add("count", std::move(fans.count), false);
    packing.add("rim", std::move(fans.rim), false);
    if (scene.labelNames.size() > 1) packing.add("labels", orZero(scene.mesh.label));
    if (!scene.number.empty()) packing.add("numbers", orZero(scene.number));
    std::map<std::string, std::string> texts = packing.texts();
    texts.emplace("labels", "null");
    texts.emplace("numbers", "null");
    return texts;
}

double spacingOf(const ViewScene& scene, const Range& range) {
    if (scene.isolineSpacing != 0) return std::max(scene.isolineSpacing, 0.0);
    return scene.grows && range.high > range.low ? roundSpacing(range.high - range.low, 16) : 0;
}

std::string sceneJson(const ViewScene& scene) {
    const SceneBox box(scene);
    const Range range(scene);
    const Shares shares(scene);
    const std::map<std::string, std::string> arrays = arraysOf(scene, box, range);
    auto at = [&](const char* name) -> const std::string& { return arrays.at(name); };
    auto points = [&](const std::string& name) {
        return fmt::format("\"x\":{},\"y\":{},\"z\":{}", arrays.at(name + "x"),
                           arrays.at(name + "y"), arrays.at(name + "z"));
    };
    const std::string curves = list(scene.lines, [](const NamedCurve& line) {
        return fmt::format("{{\"name\":{},\"count\":{}}}", jsonString(line.name),
                           line.points.size());
    });
    // Without any distance the largest is below the least.
    std::string text = fmt::format(
        R"({{"quantity":{},"unit":{},"rest":{},"grows":{},"low":{},"high":{},"unreached":{},"blocked":{},)"
        R"("spacing":{},"corner":{},"side":{},"eye":{},"up":{},"map":{},"maps":{},)",
        jsonString(scene.quantity), jsonString(scene.unit), jsonString(scene.rest), scene.grows,
        json(range.empty() ? 0 : range.low), json(range.empty() ? -1 : range.high),
        json(scene.restShare.value_or(shares.unreached)), json(shares.blocked),
        json(spacingOf(scene, range)), json(box.low), json(box.side), json(scene.toEye),
        json(scene.up), jsonString(scene.colorMap), mapsJson());
    text += fmt::format(R"("seeds":{},"targets":{},"labelNames":{},"voxel":{},"notes":{},)",
                        json(scene.seeds), json(scene.targets), json(scene.labelNames),
                        json(scene.voxels), json(scene.notes));
    return text + fmt::format(R"("points":{{{}}},"values":{},"labels":{},"numbers":{},)"
                              R"("triangles":{{"middle":{},"count":{},"rim":{}}},)"
                              R"("lines":{{"curves":{},{}}}}})",
                              points("point"), at("values"), at("labels"), at("numbers"),
                              at("middle"), at("count"), at("rim"), curves, points("line"));
}

}  // namespace

bool hasViewer() { return !viewFiles().library.empty(); }

std::string viewPage(const ViewScene& scene) {
    using Kind = Error::Kind;
    if (!hasViewer())
        throw Error(
            Kind::InvalidArgument, "igeo was built without three.js, which draws its pages",
            "install it (Debian: libjs-three), configure and build again; or write a picture");
    if (scene.mesh.triangles.empty())
        throw Error(Kind::InvalidArgument, "a page of a surface without triangles",
                    "show a surface that has some");
    static_cast<void>(ColorMap(scene.colorMap));  // throws for unknown ones
    const ViewFiles& files = viewFiles();
    const std::string still =
        scene.still.empty() ? "" : std::string(kStill) + pngAddress(scene.still) + "\">";
    return filledIn(files.page,
                    {{"title", htmlText(scene.title)},
                     {"creator", htmlText(scene.creator)},
                     {"css", std::string(files.style)},
                     {"still", still},
                     {"license", std::string(files.license)},
                     {"scene", sceneJson(scene)},
                     {"library", base64(files.library)},
                     {"script", std::string(files.drawing) + std::string(files.script)}});
}

std::string stillOfPage(std::string_view page) {
    const std::size_t begin = page.find(kStill);
    if (begin == std::string_view::npos) return {};
    const std::string_view address = page.substr(begin + kStill.size());
    const std::string png = pngAddress({});
    const std::size_t end = address.find('"');
    const bool whole = end != std::string_view::npos && address.substr(0, png.size()) == png;
    return whole ? std::string(address.substr(0, end)) : std::string();
}

}  // namespace igeo
