# Homebrew on Linux, from a checkout: brew install --formula packaging/homebrew/cullhull.rb
class Cullhull < Formula
  desc "Exact convex hulls of very large point sets, in any dimension"
  homepage "https://github.com/cullhull/cullhull"
  url "file://#{File.expand_path("../..", __dir__)}", using: :git
  version "0.1.0"
  license "MIT"

  depends_on "cli11" => :build
  depends_on "cmake" => :build
  depends_on "fast_float" => :build
  depends_on "ninja" => :build
  depends_on "nlohmann-json" => :build
  depends_on "fmt"
  depends_on "gmp"
  depends_on "highway"
  depends_on :linux
  depends_on "zlib"
  depends_on "zstd"

  def install
    system "cmake", "-S", ".", "-B", "build", "-G", "Ninja", "-DCULLHULL_SHARED=ON",
           "-DCULLHULL_BUILD_TESTS=OFF", "-DCULLHULL_BUILD_BENCH=OFF",
           "-DCULLHULL_BUILD_EXAMPLES=OFF", "-DCULLHULL_WITH_HDF5=OFF", *std_cmake_args
    system "cmake", "--build", "build"
    system "cmake", "--install", "build"
  end

  test do
    system bin/"cullhull", "generate", "ball", "-n", "1000", "-d", "3", "-o", "ball.npy"
    system bin/"cullhull", "hull", "ball.npy", "--certify"
  end
end
