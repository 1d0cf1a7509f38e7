/// Text as coverage of pixels. Internal to the pictures.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace igeo {

/// The font that the library holds: DejaVu Sans, of which it has Latin-1. Drawn without hints, so
/// that text looks the same at any size. Not for two threads at once.
class Font {
public:
    /// @param size  pixels per em
    /// @throws Error  Internal where FreeType does not take the font
    explicit Font(double size);
    ~Font();
    Font(const Font&) = delete;
    Font& operator=(const Font&) = delete;

    double size() const;
    /// Pixels that a text in UTF-8 takes along its line.
    double width(const std::string& text) const;
    /// Calls visit(x, y, coverage in (0, 1]) for the pixels of a text that begins at (x, y) on its
    /// base line.
    void draw(const std::string& text, double x, double y,
              const std::function<void(int, int, double)>& visit) const;

private:
    struct Face;
    std::unique_ptr<Face> face_;
};

}  // namespace igeo
