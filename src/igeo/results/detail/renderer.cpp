#include <igeo/results/detail/renderer.h>

#include <igeo/base/parallel.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <numeric>

namespace igeo {

Renderer::Renderer(const DrawnSurface& surface, const Frame& frame, const Shader& shader,
                   Progress& progress)
    : surface_(surface),
      frame_(frame),
      shader_(shader),
      raster_(surface.triangles(), !surface.hidesBacks(), frame),
      progress_(progress),
      samples_(std::size_t(frame.width) * std::size_t(frame.height)),
      seen_(frame),
      edges_(raster_.tiles()),
      slopes_(new float[samples_.size()]) {}

void Renderer::render(double radius, double pixel, Film& film) {
    constexpr double kPartOfPixel = 0.25;
    sample();
    std::size_t pixels = 0;
    const std::vector<std::uint32_t> shown = shownTriangles(pixels);
    corners_.emplace(surface_, frame_, shader_, shown, pixels, kPartOfPixel * pixel);
    rows(0, [&](int y) { lookAt(y); });
    open_.emplace(seen_, radius);
    rows(1, [&](int y) { colorRow(y, film); });
    parallelFor(raster_.tiles(), 1, progress_, [&](std::size_t begin, std::size_t end) {
        std::vector<Sample> samples;
        for (std::size_t t = begin; t < end; ++t) refine(t, samples, film);
    });
}

template <typename Visit>
void Renderer::forPixels(std::size_t tile, const Visit& visit) const {
    constexpr int kTile = Raster::kTile;
    const auto [left, top] = raster_.origin(tile);
    for (int y = top; y < std::min(top + kTile, frame_.height); ++y)
        for (int x = left; x < std::min(left + kTile, frame_.width); ++x)
            visit(x, y, std::size_t((y - top) * kTile + x - left));
}

void Renderer::sample() {
    parallelFor(raster_.tiles(), 1, progress_, [&](std::size_t begin, std::size_t end) {
        const std::vector<Raster::Offset> middle{{0.5, 0.5}};
        Raster::Pixels all;
        all.fill(~0u);
        std::vector<Sample> tile(Raster::kPixels);
        for (std::size_t t = begin; t < end; ++t) {
            if (raster_.isEmpty(t)) continue;
            raster_.draw(t, middle, all, tile);
            forPixels(t, [&](int x, int y, std::size_t k) {
                samples_[std::size_t(y) * std::size_t(frame_.width) + std::size_t(x)] = tile[k];
            });
        }
    });
}

/// The triangles at the middle of a pixel, and the number of these pixels.
std::vector<std::uint32_t> Renderer::shownTriangles(std::size_t& pixels) const {
    std::vector<std::uint8_t> isShown(surface_.triangles().size());
    for (const Sample& s : samples_)
        if (s.covered()) isShown[s.triangle] = 1, ++pixels;
    std::vector<std::uint32_t> shown;
    for (std::uint32_t t = 0; t < isShown.size(); ++t)
        if (isShown[t] || surface_.hasDistances()) shown.push_back(t);
    return shown;
}

void Renderer::rows(int pass, const std::function<void(int)>& body) {
    std::atomic<int> done{0};
    parallelFor(std::size_t(frame_.height), 4, [&](std::size_t begin, std::size_t end) {
        for (int y = int(begin); y < int(end) && !progress_.cancelled(); ++y) {
            body(y);
            progress_.update("picture", (pass + double(++done) / frame_.height) / 2);
        }
    });
    progress_.throwIfCancelled();
}

void Renderer::lookAt(int y) {
    Spots odd{std::size_t(frame_.width)};
    std::vector<std::size_t> pixel;
    for (int x = 0; x < frame_.width; ++x) {
        const Sample& s = samples_[std::size_t(y) * std::size_t(frame_.width) + std::size_t(x)];
        if (!s.covered()) continue;
        const std::size_t i = seen_.index(x, y);
        const Vec3f toward = seen_.toward(x, y);
        const CornerValues::Value value = corners_->at(s, toward);
        seen_.put(i, s.depth, value.normal, shader_.known(s.depth * toward, value.distance));
        if (corners_->trust(s.triangle) == CornerValues::Linear) continue;
        odd.add(toward, s.depth, value.normal, value.distance);
        pixel.push_back(i);
    }
    std::vector<std::size_t> all(pixel.size());
    std::iota(all.begin(), all.end(), std::size_t(0));
    read(all, odd);
    for (const std::size_t k : all) seen_.distance[pixel[k]] = odd.distance[k];
}

void Renderer::read(const std::vector<std::size_t>& which, Spots& spots) const {
    std::vector<Vec3d> points;
    std::vector<Vec3f> normals;
    for (const std::size_t k : which) {
        points.push_back(frame_.inSpace(Vec3d(spots.place(k))));
        normals.emplace_back(frame_.turnedBack(Vec3d(spots.normal(k))));
    }
    std::vector<std::uint8_t> isSmooth;
    const std::vector<float> distances = shader_.read(points, normals, isSmooth);
    for (std::size_t k = 0; k < which.size(); ++k)
        spots.distance[which[k]] = shader_.known(spots.place(which[k]), distances[k]);
}

void Renderer::colorRow(int y, Film& film) {
    constexpr int kTile = Raster::kTile;
    RowEdges row;
    findEdges(seen_, y, row);
    std::vector<float> open;
    open_->row(y, open);
    Spots spots{std::size_t(frame_.width)};
    std::vector<int> columns;
    for (int x = 0; x < frame_.width; ++x) {
        const std::size_t i = seen_.index(x, y);
        if (row.edge[std::size_t(x)]) {
            edges_[raster_.tileOf(x, y)][std::size_t(y % kTile)] |= 1u << x % kTile;
            slopes_[std::size_t(y) * std::size_t(frame_.width) + std::size_t(x)] =
                row.slope[std::size_t(x)];
        } else if (seen_.covered(i)) {
            spots.add(seen_.toward(x, y), seen_.depth[i], seen_.normal(i), seen_.distance[i],
                      open[std::size_t(x)], row.slope[std::size_t(x)]);
            columns.push_back(x);
        }
    }
    std::vector<Vec3f> colors;
    shader_.color(spots, colors);
    for (std::size_t k = 0; k < columns.size(); ++k) film.at(columns[k], y) = Rgba(colors[k]);
}

void Renderer::refine(std::size_t tile, std::vector<Sample>& samples, Film& film) const {
    const Raster::Pixels& wanted = edges_[tile];
    if (std::count(wanted.begin(), wanted.end(), 0u) == Raster::kTile) return;
    // No two in one row or column of the pixel.
    std::vector<Raster::Offset> offsets;
    for (int a = 0; a < kFiner; ++a)
        for (int b = 0; b < kFiner; ++b)
            offsets.push_back(
                {(a + (b + 0.5) / kFiner) / kFiner, (b + (a + 0.5) / kFiner) / kFiner});
    samples.resize(Raster::kPixels * offsets.size());
    raster_.draw(tile, offsets, wanted, samples);
    std::size_t pixels = 0;
    for (const std::uint32_t row : wanted) pixels += std::size_t(std::popcount(row));
    Spots spots(pixels * offsets.size());
    std::vector<Rgba*> pixel;
    std::vector<std::size_t> odd;
    forPixels(tile, [&](int x, int y, std::size_t k) {
        if (!(wanted[k / Raster::kTile] >> k % Raster::kTile & 1)) return;
        const float slope = slopes_[std::size_t(y) * std::size_t(frame_.width) + std::size_t(x)];
        for (std::size_t o = 0; o < offsets.size(); ++o) {
            const Sample& s = samples[k * offsets.size() + o];
            if (!s.covered()) continue;
            const Vec3f toward(frame_.toward(x + offsets[o][0], y + offsets[o][1]));
            const CornerValues::Value value = corners_->at(s, toward);
            if (corners_->trust(s.triangle) == CornerValues::None) odd.push_back(spots.size());
            spots.add(toward, s.depth, value.normal,
                      shader_.known(s.depth * toward, value.distance), open_->at(x, y, s.depth),
                      slope / kFiner);
            pixel.push_back(&film.at(x, y));
        }
    });
    read(odd, spots);
    std::vector<Vec3f> colors;
    shader_.color(spots, colors);
    const auto share = float(1.0 / double(offsets.size()));
    for (std::size_t k = 0; k < pixel.size(); ++k) *pixel[k] += Rgba(colors[k]) * share;
}

}  // namespace igeo
