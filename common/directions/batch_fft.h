#pragma once
// Fourier transforms of many sequences at once, one in each lane of the machine's vectors: what rings of a sphere need,
// which come by the hundred and are short.
#include <cstddef>
#include <span>
#include <vector>

namespace kokage {

/// Discrete Fourier transforms of kLanes complex sequences of one length, side by side.
class BatchFft {
  public:
    static constexpr std::size_t kLanes = 16;
    /// Floats that hold element k of all sequences: kLanes real parts, then kLanes imaginary parts.
    static constexpr std::size_t kElement = 2 * kLanes;

    /// Any length >= 1; fast where its prime factors are small.
    explicit BatchFft(int length);
    int length() const { return length_; }
    std::size_t floats() const { return std::size_t(length_) * kElement; }

    /// X_k = sum over n of x_n e^(-2 pi i k n / length). `values` and `scratch` have floats() floats; the result stands
    /// in one of the two, and which one is returned. Error: a few 1e-7 of the sequence's root of sum of squares.
    std::span<float> forward(std::span<float> values, std::span<float> scratch) const;
    /// The same with e^(+2 pi i k n / length), not divided by length.
    std::span<float> backward(std::span<float> values, std::span<float> scratch) const;

  private:
    std::span<float> transform(std::span<float> values, std::span<float> scratch, std::size_t real,
                               std::size_t imaginary) const;

    int length_;
    std::vector<int> factors_;
    std::vector<float> turns_; ///< cos, -sin of 2 pi k / length
};

} // namespace kokage
