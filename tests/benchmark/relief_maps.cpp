#include "tests/benchmark/relief_maps.h"
#include "common/services/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace kokage {
namespace {

/// Gradient noise (Perlin 1985, with the quintic fade of Perlin 2002) on a lattice of `columns` x `rows` a tile:
/// periodic, within about [-0.7, 0.7].
class TileNoise {
  public:
    TileNoise(int columns, int rows, std::uint64_t seed) : columns_(columns), rows_(rows) {
        Random random(seed);
        for (int i = 0; i < columns * rows; ++i) {
            const double turn = 2 * std::numbers::pi * random.uniform_double();
            gradients_.push_back({std::cos(turn), std::sin(turn)});
        }
    }
    double operator()(double u, double v) const {
        const double x = u * columns_, y = v * rows_, i = std::floor(x), j = std::floor(y), a = x - i, b = y - j;
        const auto corner = [&](int di, int dj) {
            const glm::dvec2& g =
                gradients_[std::size_t(wrapped(j + dj, rows_) * columns_ + wrapped(i + di, columns_))];
            return g.x * (a - di) + g.y * (b - dj);
        };
        const double s = fade(a), t = fade(b);
        return std::lerp(std::lerp(corner(0, 0), corner(1, 0), s), std::lerp(corner(0, 1), corner(1, 1), s), t);
    }

  private:
    static double fade(double a) { return a * a * a * (a * (a * 6 - 15) + 10); }
    static int wrapped(double i, int count) { return int(i - count * std::floor(i / count)); }

    int columns_, rows_;
    std::vector<glm::dvec2> gradients_;
};

/// Heights of bark: crests upright along v, fissures between them.
class Bark {
  public:
    explicit Bark(std::uint64_t seed)
        : warp_u_(5, 4, hash64(seed + 1)), warp_v_(5, 4, hash64(seed + 2)), broad_(9, 3, hash64(seed + 3)),
          fine_(17, 6, hash64(seed + 4)) {
        for (int octave = 0; octave < 4; ++octave)
            octaves_.emplace_back(24 << octave, 16 << octave, hash64(seed + 5 + std::uint64_t(octave)));
    }
    double operator()(double u, double v) const {
        const double x = u + 0.03 * warp_u_(u, v), y = v + 0.06 * warp_v_(u, v);
        double height = 0.62 * ridge(broad_(x, y)) + 0.28 * ridge(fine_(x, y)), share = 0.16;
        for (const TileNoise& octave : octaves_) {
            height += share * octave(u, v);
            share /= 2;
        }
        return height;
    }

  private:
    /// Ridged noise (Musgrave 1994): a sharp crest of height 1 along the lines where the noise is 0.
    static double ridge(double noise) { return 1 - 2 * std::abs(noise); }

    TileNoise warp_u_, warp_v_, broad_, fine_;
    std::vector<TileNoise> octaves_;
};

/// The way from a to b on a tile that repeats, within [-0.5, 0.5].
double across_tile(double a, double b) {
    return b - a - std::round(b - a);
}

class Spikes {
  public:
    explicit Spikes(std::uint64_t seed) {
        Random random(hash64(seed + 0x5b1ce5));
        for (int i = 0; i < 48; ++i) {
            Spike spike;
            spike.u = random.uniform_double();
            spike.v = random.uniform_double();
            spike.radius = 0.025 + 0.06 * random.uniform_double();
            spike.height = 0.4 + 0.6 * random.uniform_double();
            const double turn = random.uniform_double() * std::numbers::pi / 2;
            spike.cos = std::cos(turn);
            spike.sin = std::sin(turn);
            spike.is_cone = i % 2 == 0;
            spikes_.push_back(spike);
        }
    }
    double operator()(double u, double v) const {
        double height = 0;
        for (const Spike& spike : spikes_) {
            const double x = across_tile(spike.u, u), y = across_tile(spike.v, v);
            const double p = std::abs(spike.cos * x + spike.sin * y), q = std::abs(spike.cos * y - spike.sin * x);
            const double distance = spike.is_cone ? std::hypot(x, y) : std::max(p, q);
            height = std::max(height, spike.height * (1 - distance / spike.radius));
        }
        return height;
    }

  private:
    struct Spike {
        double u = 0, v = 0, radius = 0, height = 0, cos = 1, sin = 0;
        bool is_cone = true;
    };
    std::vector<Spike> spikes_;
};

class Low {
  public:
    explicit Low(std::uint64_t seed) {
        Random random(hash64(seed + 0x1053));
        for (int i = 0; i < 14; ++i) {
            Post post;
            post.u = random.uniform_double();
            post.v = random.uniform_double();
            post.radius = 0.012 + 0.018 * random.uniform_double();
            post.height = 0.5 + 0.5 * random.uniform_double();
            posts_.push_back(post);
        }
    }
    double operator()(double u, double v) const {
        constexpr double turn = 2 * std::numbers::pi;
        double height = 0.015 * (1 + std::sin(turn * (6 * u + 2 * v)) * std::sin(turn * (7 * v - 3 * u)));
        for (const Post& post : posts_) {
            const double distance = std::hypot(across_tile(post.u, u), across_tile(post.v, v));
            // The wall falls within 0.8 % of the tile, so that sizes from 256 on show the same post.
            height = std::max(height, post.height * std::clamp((post.radius - distance) / 0.008, 0., 1.));
        }
        return height;
    }

  private:
    struct Post {
        double u = 0, v = 0, radius = 0, height = 0;
    };
    std::vector<Post> posts_;
};

template <class Heights>
HeightField sample(const Heights& heights, int width, int height) {
    HeightField field{width, height, HeightWrap::repeat, {}};
    std::vector<double> values;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            values.push_back(heights((x + 0.5) / width, (y + 0.5) / height));
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    const double low = *least, high = *most;
    for (const double value : values)
        field.depths.push_back(high > low ? float((high - value) / (high - low)) : 0.f);
    return field;
}

} // namespace

std::string_view relief_map_name(ReliefMap map) {
    return map == ReliefMap::bark ? "bark" : map == ReliefMap::spikes ? "spikes" : "low";
}

HeightField make_relief_map(ReliefMap map, int width, int height, std::uint64_t seed) {
    switch (map) {
    case ReliefMap::bark:
        return sample(Bark(seed), width, height);
    case ReliefMap::spikes:
        return sample(Spikes(seed), width, height);
    case ReliefMap::low:
        break;
    }
    return sample(Low(seed), width, height);
}

} // namespace kokage
