/// Ambient occlusion of a picture's pixels. Internal to the pictures.
#pragma once

#include <igeo/results/detail/seen_pixels.h>

#include <vector>

namespace igeo {

/// From 0, occluded, to 1, open: folds and holes are darker than ridges. Computed in screen space,
/// for blocks of 2 x 2 pixels: what rises above the tangent plane within a radius, sampled at 8
/// blocks around, smoothed over 4 x 4 (after M. McGuire et al., Scalable ambient obscurance, 2012).
/// Linear between blocks.
class Openness {
public:
    /// @param radius  index units
    /// In parallel; the same bits for any number of threads.
    Openness(const SeenPixels& seen, double radius);

    /// At the pixels of a row; 1 on the background.
    void row(int y, std::vector<float>& open) const;
    /// At a sample of a pixel: that of the block around with the closest depth.
    float at(int x, int y, float depth) const;

private:
    /// The first pixel of a block that shows the surface, in camera coordinates.
    struct Block {
        Vec3f place, normal;
        float open = 1;
        bool covered = false;
    };
    const Block& block(int x, int y) const {
        return blocks_[std::size_t(y) * std::size_t(across_) + std::size_t(x)];
    }
    bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < across_ && y < down_; }
    bool onSheet(const Block& sheet, const Block& b) const;
    /// The value of another block, or of this one if that is not on its sheet.
    float beside(const Block& here, int x, int y) const {
        return holds(x, y) && onSheet(here, block(x, y)) ? block(x, y).open : here.open;
    }
    void place(int x, int y);
    float blocked(int x, int y) const;
    float smoothed(const std::vector<float>& values, int x, int y) const;

    const SeenPixels& seen_;
    float radius_;
    int across_, down_;
    std::vector<Block> blocks_;
};

}  // namespace igeo
