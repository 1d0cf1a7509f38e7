#include <igeo/results/detail/renderer.h>

#include <igeo/base/detail/steps.h>
#include <igeo/base/parallel.h>

#include <algorithm>
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
      samples_(new FourSamples[raster_.tiles() * Raster::Centers::kPerTile]),
      seen_(frame),
      edges_(raster_.tiles()),
      slopes_(new float[std::size_t(frame.width) * std::size_t(frame.height)]) {}

void Renderer::render(double radius, double pixel, Film& film) {
    constexpr double kPartOfPixel = 0.25;
    sample();
    std::size_t pixels = 0;
    const std::vector<std::uint32_t> shown = shownTriangles(pixels);
    corners_.emplace(surface_, frame_, shader_, shown, pixels, kPartOfPixel * pixel);
    rows(0, [&](int top, int bottom, const RowDone& done) { lookAt(top, bottom, done); });
    open_.emplace(seen_, radius);
    rows(1, [&](int top, int bottom, const RowDone& done) {
        for (int y = top; y < bottom; ++y) colorRow(y, film), done();
    });
    parallelFor(raster_.tiles(), 1, progress_, [&](std::size_t begin, std::size_t end) {
        const Raster::Finer finer = Raster::finer();
        for (std::size_t t = begin; t < end; ++t) refine(t, finer, film);
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

/// Leaves the first columns of a tile.
void Renderer::keepColumns(int columns, FourSamples* tile) {
    for (std::size_t k = 0; k < Raster::kPixels; ++k)
        if (int(k % Raster::kTile) >= columns) {
            FourSamples& samples = tile[k / FourSamples::kLanes];
            samples.triangle[k % FourSamples::kLanes] = FourSamples::kNone;
            samples.depth[k % FourSamples::kLanes] = FourSamples::kFar;
        }
}

void Renderer::sample() {
    parallelFor(raster_.tiles(), 1, progress_, [&](std::size_t begin, std::size_t end) {
        const Raster::Centers centers = Raster::centers();
        Raster::Pixels all;
        all.fill(~0u);
        for (std::size_t t = begin; t < end; ++t)
            if (!raster_.isEmpty(t)) {
                FourSamples* const samples = &samples_[t * Raster::Centers::kPerTile];
                raster_.draw(t, centers, all, samples);
                if (const int shown = frame_.width - raster_.origin(t)[0]; shown < Raster::kTile)
                    keepColumns(shown, samples);
            }
    });
}

/// The triangles at the middle of a pixel, and the number of these pixels.
std::vector<std::uint32_t> Renderer::shownTriangles(std::size_t& pixels) const {
    std::vector<std::uint8_t> isShown(surface_.triangles().size());
    for (int y = 0; y < frame_.height; ++y)
        for (int x = 0; x < frame_.width; x += int(FourSamples::kLanes)) {
            const FourSamples& samples = samplesAt(x, y);
            if (!samples.anyCovered()) continue;
            for (std::size_t lane = 0; lane < FourSamples::kLanes; ++lane)
                if (samples.covered(lane)) isShown[samples.triangle[lane]] = 1, ++pixels;
        }
    std::vector<std::uint32_t> shown;
    for (std::uint32_t t = 0; t < isShown.size(); ++t)
        if (isShown[t] || surface_.hasDistances()) shown.push_back(t);
    return shown;
}

void Renderer::rows(int pass, const std::function<void(int, int, const RowDone&)>& body) {
    constexpr int kRows = 16;
    Steps steps(progress_, "picture", std::size_t(frame_.height), pass / 2.0, (pass + 1) / 2.0);
    const RowDone rowDone = [&] { steps.add(1); };
    const auto parts = std::size_t((frame_.height + kRows - 1) / kRows);
    parallelFor(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (int k = int(begin); k < int(end) && !progress_.cancelled(); ++k)
            body(k * kRows, std::min((k + 1) * kRows, frame_.height), rowDone);
    });
    progress_.throwIfCancelled();
}

void Renderer::lookAt(int top, int bottom, const RowDone& rowDone) {
    std::vector<std::size_t> odd;
    for (int y = top; y < bottom; ++y) lookAt(y, odd), rowDone();
    SpotList list(odd.size());
    for (const std::size_t i : odd) {
        const Vec3f toward =
            seen_.toward(int(i % seen_.stride) - SeenPixels::kPad, int(i / seen_.stride) - 1);
        list.add({toward.x, toward.y, seen_.depth[i], seen_.nx[i], seen_.ny[i], seen_.nz[i],
                  seen_.distance[i], 1, 0});
    }
    std::vector<std::size_t> all(odd.size());
    std::iota(all.begin(), all.end(), std::size_t(0));
    const Spots spots = list.spots();
    read(all, spots);
    for (const std::size_t k : all) seen_.distance[odd[k]] = spots.distance[k];
}

void Renderer::lookAt(int y, std::vector<std::size_t>& odd) {
    for (int x = 0; x < frame_.width; x += int(FourSamples::kLanes)) {
        const FourSamples& samples = samplesAt(x, y);
        const std::size_t i = seen_.index(x, y);
        if (!samples.anyCovered()) continue;
        const CornerValues::Values values =
            corners_->at(samples, loadLanes<4>(&seen_.towardX[std::size_t(x + SeenPixels::kPad)]),
                         CornerValues::Values::Four{} + seen_.towardY[std::size_t(y)]);
        storeLanes(samples.depth, &seen_.depth[i]);
        storeLanes(values.nx, &seen_.nx[i]);
        storeLanes(values.ny, &seen_.ny[i]);
        storeLanes(values.nz, &seen_.nz[i]);
        storeLanes(values.distance, &seen_.distance[i]);
        for (std::size_t lane = 0; lane < FourSamples::kLanes; ++lane)
            if (samples.covered(lane) &&
                corners_->trust(samples.triangle[lane]) != CornerValues::Linear)
                odd.push_back(i + lane);
    }
    for (int x = 0; x < frame_.width && !shader_.knowsAll(); ++x) {
        const std::size_t i = seen_.index(x, y);
        if (seen_.covered(i))
            seen_.distance[i] = shader_.known(seen_.place(x, y), seen_.distance[i]);
    }
}

/// The pixels of a row.
Spots Renderer::spotsOf(int y, const float* towardY, const float* open, const float* slope) {
    const std::size_t i = seen_.index(0, y);
    return {&seen_.towardX[SeenPixels::kPad],
            towardY,
            &seen_.depth[i],
            &seen_.nx[i],
            &seen_.ny[i],
            &seen_.nz[i],
            &seen_.distance[i],
            open,
            slope,
            std::size_t(frame_.width)};
}

void Renderer::read(const std::vector<std::size_t>& which, const Spots& spots) const {
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
    const RowEdges row(seen_, y);
    std::vector<float> open;
    open_->row(y, open);
    const std::vector<float> towardY(seen_.stride, seen_.towardY[std::size_t(y)]);
    shader_.color(spotsOf(y, towardY.data(), open.data(), row.slope.get()), &film.at(0, y));
    for (int x = 0; x < frame_.width; ++x) {
        if (!row.edge[std::size_t(x)]) continue;
        film.at(x, y) = {};
        edges_[raster_.tileOf(x, y)][std::size_t(y % kTile)] |= 1u << x % kTile;
        slopes_[std::size_t(y) * std::size_t(frame_.width) + std::size_t(x)] =
            row.slope[std::size_t(x)];
    }
}

void Renderer::refine(std::size_t tile, const Raster::Finer& finer, Film& film) const {
    constexpr std::size_t kSamples = std::size_t(Raster::kFiner) * Raster::kFiner;
    const Raster::Pixels& wanted = edges_[tile];
    if (std::count(wanted.begin(), wanted.end(), 0u) == Raster::kTile) return;
    const std::unique_ptr<FourSamples[]> all(new FourSamples[Raster::Finer::kPerTile]);
    raster_.draw(tile, finer, wanted, all.get());
    std::size_t pixels = 0;
    for (const std::uint32_t row : wanted) pixels += std::size_t(std::popcount(row));
    SpotList list(pixels * kSamples);
    std::vector<Rgba*> pixel;
    std::vector<std::size_t> odd;
    auto add = [&](int x, int y, const FourSamples& samples, std::size_t r) {
        constexpr std::size_t kLanes = FourSamples::kLanes;
        const float slope = slopes_[std::size_t(y) * std::size_t(frame_.width) + std::size_t(x)];
        std::array<float, kLanes> towardX, towardY;
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const Vec3f toward(frame_.toward(x + finer.x[r][lane], y + finer.y[r][lane]));
            towardX[lane] = toward.x, towardY[lane] = toward.y;
        }
        const CornerValues::Values values =
            corners_->at(samples, loadLanes<4>(towardX.data()), loadLanes<4>(towardY.data()));
        for (std::size_t lane = 0; lane < std::min(kLanes, kSamples - r * kLanes); ++lane) {
            if (!samples.covered(lane)) continue;
            const float depth = samples.depth[lane];
            if (corners_->trust(samples.triangle[lane]) == CornerValues::None)
                odd.push_back(list.size());
            list.add({towardX[lane], towardY[lane], depth, values.nx[lane], values.ny[lane],
                      values.nz[lane],
                      shader_.known(depth * Vec3f{towardX[lane], towardY[lane], 1},
                                    values.distance[lane]),
                      open_->at(x, y, depth), slope / Raster::kFiner});
            pixel.push_back(&film.at(x, y));
        }
    };
    forPixels(tile, [&](int x, int y, std::size_t k) {
        if (!(wanted[k / Raster::kTile] >> k % Raster::kTile & 1)) return;
        for (std::size_t r = 0; r < finer.x.size(); ++r) add(x, y, all[k * finer.x.size() + r], r);
    });
    const Spots spots = list.spots();
    read(odd, spots);
    std::vector<Rgba> colors(list.size() + FourSamples::kLanes);
    shader_.color(spots, colors.data());
    const auto share = float(1.0 / double(kSamples));
    for (std::size_t k = 0; k < pixel.size(); ++k) *pixel[k] += colors[k] * share;
}

}  // namespace igeo
