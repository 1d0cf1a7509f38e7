# Not run: checked by `ruby -c` only; brew never built it.
# PLACEHOLDER: the project has no public home yet; homepage, url and sha256 stand for those of a release.
class ImplicitGeodesic < Formula
  desc "Geodesic distances on level sets, meshes and points"
  homepage "https://example.org/PLACEHOLDER"
  url "https://example.org/PLACEHOLDER/implicit-geodesic-0.2.0.tar.gz"
  sha256 "0000000000000000000000000000000000000000000000000000000000000000"
  license "Apache-2.0"

  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "ninja" => :build
  depends_on "nlohmann-json" => :build
  depends_on "xxhash" => :build
  depends_on "assimp"
  depends_on "boost"
  depends_on "fmt"
  depends_on "freetype"
  depends_on "libpng"
  depends_on "openvdb"
  depends_on "tbb"

  # Homebrew has no three.js: the program is built without --view.
  uses_from_macos "python" => :build # makes the manual page and the completions
  uses_from_macos "zlib"

  def install
    system "cmake", "-S", ".", "-B", "build", "-G", "Ninja",
           "-DIGEO_BUILD_TESTS=OFF", "-DIGEO_SHARED=ON", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    output = shell_output("#{bin}/implicit-geodesic --sdf #{share}/implicit-geodesic/data/sphere.vdb " \
                          "--seed 0,0,1 --target 0,0,-1 -o out.vdb 2>&1")
    assert_match "target 0: distance 3.14", output
  end
end
