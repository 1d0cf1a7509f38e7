/// Text as pixel coverage. Internal to the pictures.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace igeo {

/// The built-in font: DejaVu Sans, Latin-1 only. Drawn without hinting, so that text looks the same
/// at any size. For one thread at a time.
class Font {
public:
    /// @param size  pixels per em
    /// @throws Error  Internal where FreeType refuses the font
    explicit Font(double size);
    ~Font();
    Font(const Font&) = delete;
    Font& operator=(const Font&) = delete;

    double size() const;
    /// The width of a UTF-8 text in pixels.
    double width(const std::string& text) const;
    /// Calls visit(x, y, coverage in (0, 1]) for the pixels of a text that starts at (x, y) on its
    /// base line.
    void draw(const std::string& text, double x, double y,
              const std::function<void(int, int, double)>& visit) const;

private:
    struct Face;
    std::unique_ptr<Face> face_;
};

}  // namespace igeo
