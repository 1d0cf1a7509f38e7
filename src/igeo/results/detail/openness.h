/// Ambient occlusion of a picture's pixels. Internal to the pictures.
#pragma once

#include <igeo/results/detail/seen_pixels.h>

#include <vector>

namespace igeo {

/// Blocks of pixels, with blocks of the background around the picture, so that neighbors and
/// registers of blocks need no test.
struct OpenBlocks {
    static constexpr int kBlock = 2;  ///< pixels along a side
    static constexpr int kPad = 8;

    /// Of the first pixel that shows the surface, in camera coordinates.
    struct Place {
        float x = 0, y = 0, z = std::numeric_limits<float>::infinity(), none = 0;
        bool covered() const { return z < std::numeric_limits<float>::infinity(); }
    };
    struct Normal {
        float x = 0, y = 0, z = 0, none = 0;  ///< unit, toward the eye
    };

    int across, down;
    std::size_t stride;  ///< from one row to the next
    float radius, perPixel;
    std::vector<Place> place;
    std::vector<Normal> normal;
    std::vector<float> blocked, open;  ///< shares of light; `blocked` has the pattern's noise

    OpenBlocks(const SeenPixels& seen, float radius);

    std::size_t index(int x, int y) const {
        return std::size_t(y + kPad) * stride + std::size_t(x + kPad);
    }
};

/// From 0, occluded, to 1, open: folds and holes are darker than ridges. Computed in screen space,
/// for blocks of 2 x 2 pixels: what rises above the tangent plane within a radius, sampled at 8
/// blocks around, smoothed over 4 x 4 (after M. McGuire et al., Scalable ambient obscurance, 2012).
/// Linear between blocks.
class Openness {
public:
    /// In parallel; the same bits for any number of threads.
    /// @param radius  index units
    Openness(const SeenPixels& seen, double radius);

    /// At the pixels of a row; 1 on the background.
    void row(int y, std::vector<float>& open) const;
    /// At a sample of a pixel: that of the block around with the closest depth.
    float at(int x, int y, float depth) const;

private:
    static constexpr int kBlock = OpenBlocks::kBlock;

    void place(int x, int y);

    const SeenPixels& seen_;
    OpenBlocks blocks_;
};

}  // namespace igeo
