/// The surface of a picture, without lines and marks over it. Internal to the pictures.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/results/detail/corner_values.h>
#include <igeo/results/detail/film.h>
#include <igeo/results/detail/openness.h>
#include <igeo/results/detail/seen_pixels.h>

#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace igeo {

/// Draws the surface: one sample per pixel, then more where pixels show different parts of the
/// surface. Lines are antialiased by their width at a sample.
class Renderer {
public:
    Renderer(const DrawnSurface& surface, const Frame& frame, const Shader& shader,
             Progress& progress);

    /// @param radius  of the shading in folds, voxels
    /// @param pixel   width of a pixel on the surface, voxels
    void render(double radius, double pixel, Film& film);
    const SeenPixels& seen() const { return seen_; }

private:
    static void keepColumns(int columns, FourSamples* tile);
    void sample();
    std::vector<std::uint32_t> shownTriangles(std::size_t& pixels) const;
    using RowDone = std::function<void()>;
    /// Calls body(top, bottom, rowDone) for all rows, some at a time; `pass` 0 or 1 of 2.
    void rows(int pass, const std::function<void(int, int, const RowDone&)>& body);
    /// Finds what is seen in rows: pixels whose distances corners do not tell are read together.
    void lookAt(int top, int bottom, const RowDone& rowDone);
    /// @param odd  gets these pixels, as indices of seen_
    void lookAt(int y, std::vector<std::size_t>& odd);
    Spots spotsOf(int y, const float* towardY, const float* open, const float* slope);
    void colorRow(int y, Film& film);
    void refine(std::size_t tile, const Raster::Finer& finer, Film& film) const;
    /// Reads the distances of these spots of all, where corners do not tell them.
    void read(const std::vector<std::size_t>& which, const Spots& spots) const;
    /// Those at the centers of a pixel and of the next three.
    const FourSamples& samplesAt(int x, int y) const {
        constexpr int kTile = Raster::kTile;
        return samples_[(raster_.tileOf(x, y) * Raster::kPixels +
                         std::size_t(y % kTile * kTile + x % kTile)) /
                        FourSamples::kLanes];
    }
    /// Calls visit(x, y, number in the tile) for the pixels of a tile.
    template <typename Visit>
    void forPixels(std::size_t tile, const Visit& visit) const;

    const DrawnSurface& surface_;
    const Frame& frame_;
    const Shader& shader_;
    const Raster raster_;
    Progress& progress_;
    std::unique_ptr<FourSamples[]> samples_;  ///< at the centers of the pixels, tile by tile
    SeenPixels seen_;
    std::optional<CornerValues> corners_;
    std::optional<Openness> open_;
    std::vector<Raster::Pixels> edges_;  ///< per tile: pixels with an edge
    std::unique_ptr<float[]> slopes_;    ///< at these pixels
};

}  // namespace igeo
