// How a weight table is made: which texels share a row, and what each row sums.
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/maps/direction_bands.h"
#include "reflection/maps/weight_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <unordered_map>

namespace kokage {

namespace {

constexpr std::uint64_t kMostTexels = std::uint64_t(1) << 27; // beside 5 bits of symmetry in 32
constexpr double kGrid = 1 << 20;                             // steps that symmetric directions are compared in
constexpr double kPaperCut = 3;      // x threshold: matches the paper's table 2 and sizes of table
constexpr double kNegligible = 1e-9; // of the peak: what eq 9's whole hemisphere is summed down to

/// A texel's direction as its symmetry takes it from the sector where x is largest and nothing negative.
struct Placed {
    glm::ivec3 direction; ///< in grid steps, within the sector
    std::uint32_t symmetry;
};

Placed placed(const glm::vec3& direction) {
    const glm::ivec3 steps(int(std::lround(direction.x * kGrid)), int(std::lround(direction.y * kGrid)),
                           int(std::lround(direction.z * kGrid)));
    const glm::ivec3 size = glm::abs(steps);
    std::uint32_t signs = 0;
    for (std::uint32_t axis = 0; axis < 3; ++axis)
        signs |= (steps[axis] < 0 ? 1u : 0u) << axis;
    // Of the three turns that lead here, the one from the lexicographically largest place: symmetric texels agree.
    const glm::ivec3 from[3] = {size, {size.z, size.x, size.y}, {size.y, size.z, size.x}}; // inverse of turns 0, 1, 2
    std::uint32_t best = 0;
    for (std::uint32_t turn : {1u, 2u})
        if (std::tie(from[turn].x, from[turn].y, from[turn].z) > std::tie(from[best].x, from[best].y, from[best].z))
            best = turn;
    return {from[best], best * 8 + signs};
}

/// A number whose last three of 24 bits are rounded away: what differs by less is the same.
std::uint32_t coarse_bits(float value) {
    return (std::bit_cast<std::uint32_t>(value) + 4) >> 3;
}

struct RowKey {
    glm::ivec3 direction;
    std::uint32_t parameter;
    bool operator==(const RowKey&) const = default;
};
struct RowKeyHash {
    std::size_t operator()(const RowKey& key) const {
        const auto bits = [](int a, int b) { return std::uint64_t(std::uint32_t(a)) << 32 | std::uint32_t(b); };
        return std::size_t(
            hash64(bits(key.direction.x, key.direction.y) ^ hash64(bits(key.direction.z, int(key.parameter)))));
    }
};

double kept_share(const TableSettings& settings) {
    return settings.weights == TableWeights::paper ? kPaperCut * settings.threshold : settings.threshold;
}

double peak_of(const Lobe& lobe) {
    return lobe_value(lobe, 0);
}

int level_of(const Lobe& lobe, double vertices_a_lobe) {
    for (int level = kDomeLevels - 1; level > 0; --level) {
        const double vertices = 10.0 * kDomeEdges[level] * kDomeEdges[level] + 2;
        if (vertices / (4 * kPiDouble * peak_of(lobe)) >= vertices_a_lobe)
            return level;
    }
    return 0;
}

/// Entries of a row, judged by the solid angle pi d^2 of the cap that its lobe reaches.
double expected_entries(const Lobe& lobe, const TableSettings& settings) {
    const int edges = kDomeEdges[level_of(lobe, settings.vertices_a_lobe)];
    return std::max(3.0, (10.0 * edges * edges + 2) * lobe_reach(lobe, kept_share(settings)) / 4);
}

void check_settings(const TableSettings& settings) {
    if (!(settings.threshold > 0 && settings.threshold < 0.3))
        throw InputError("a weight table's threshold must be above 0 and below 0.3, not " +
                         std::to_string(settings.threshold));
    if (!(settings.vertices_a_lobe > 0 && std::isfinite(settings.vertices_a_lobe)))
        throw InputError("a weight table's vertices a lobe must be a number above 0");
}

double angle_of_chord(double squared_distance) {
    return 2 * std::asin(std::min(1.0, std::sqrt(squared_distance) / 2));
}

/// Mean of 1 - cosine that reducing the image to a level's pixels and taking it bilinearly blurs by: half the sum of
/// the variances along a meridian and along a parallel, where pixels are narrower, by 2/3 of the square on the mean. A
/// hat over pixels of width h has variance h^2/6; the mean over a pixel h^2/12, of which the finest level has none.
double pyramid_blur(int level) {
    const auto squared_pixel = [](int width) { return std::pow(2 * kPiDouble / width, 2); };
    const double h = squared_pixel(kPyramidWidths[level]), finest = squared_pixel(kPyramidWidths[0]);
    return 0.5 * (1 + 2.0 / 3) * (h / 6 + (h - finest) / 12);
}

/// One dome, ready to be searched.
class DomeWeights {
  public:
    explicit DomeWeights(int level)
        : dome_(dome_of_level(level).dome), bands_(dome_.directions), blur_(pyramid_blur(level)) {
        triangles_of_.resize(dome_.directions.size());
        for (std::uint32_t t = 0; t < dome_.triangles.size(); ++t)
            for (int corner = 0; corner < 3; ++corner)
                triangles_of_[dome_.triangles[t][glm::length_t(corner)]].push_back(t);
    }

    struct Entry {
        std::uint32_t vertex;
        double weight;
    };

    /// `near`: scratch.
    void find_row(const glm::dvec3& axis, const Lobe& lobe, const TableSettings& settings,
                  std::vector<std::uint32_t>& near, std::vector<Entry>& row) const {
        row.clear();
        const bool paper = settings.weights == TableWeights::paper;
        const double peak = peak_of(lobe), kept = kept_share(settings) * peak;
        const double reach = lobe_reach(lobe, paper ? kNegligible : kept_share(settings));
        near.clear();
        bands_.near(axis, angle_of_chord(reach), near);
        double sum = 0;
        for (std::uint32_t vertex : near) {
            const glm::dvec3 apart = dome_.directions[vertex] - axis;
            const double value = lobe_value(lobe, glm::dot(apart, apart));
            const double weight = paper ? value : value * dome_.weights[vertex];
            if (paper || value > kept)
                sum += weight;
            if (value > kept)
                row.push_back({vertex, weight});
        }
        // Fewer vertices than a triangle has: the lobe is narrower than the dome is fine, and sees a point of it.
        if (row.size() < 3 && !paper)
            return interpolate(axis, near, row);
        for (Entry& entry : row)
            entry.weight /= sum;
        if (settings.weights == TableWeights::matched)
            match_mean_direction(axis, lobe, reach, row);
    }

  private:
    /// Exponential tilting: of all weights with the wanted mean, those that differ least from the given ones
    /// (Kullback-Leibler). b by Newton's method, whose matrix is the covariance of the directions.
    void match_mean_direction(const glm::dvec3& axis, const Lobe& lobe, double reach, std::vector<Entry>& row) const {
        // In w = 1 - cosine: the cap of the reach has the mean w = reach/4 under even weights.
        const double wanted_w = std::min(1 - lobe_coefficients(lobe, 2)[1] - blur_, reach / 4);
        if (wanted_w <= 0 || row.size() < 6)
            return;
        constexpr int kMostSteps = 12;
        constexpr double kEnough = 1e-4; // of the wanted width
        const std::vector<Entry> before = row;
        glm::dvec3 tilt(0);
        for (int step = 0; step < kMostSteps; ++step) {
            double sum = 0;
            glm::dvec3 mean(0);
            glm::dmat3 square(0);
            for (std::size_t e = 0; e < row.size(); ++e) {
                const glm::dvec3 apart = dome_.directions[row[e].vertex] - axis;
                row[e].weight = before[e].weight * std::exp(glm::dot(tilt, apart));
                sum += row[e].weight;
                mean += row[e].weight * apart;
                square += row[e].weight * glm::outerProduct(apart, apart);
            }
            mean /= sum;
            for (Entry& entry : row)
                entry.weight /= sum;
            const glm::dvec3 error = -wanted_w * axis - mean;
            if (glm::dot(error, error) < kEnough * kEnough * wanted_w * wanted_w)
                return;
            tilt += glm::inverse(square / sum - glm::outerProduct(mean, mean)) * error;
            if (!(glm::length(tilt) * std::sqrt(reach) < 50))
                break;
        }
        row = before; // no tilt leads there
    }

    /// Linear interpolation in the triangle around a direction.
    void interpolate(const glm::dvec3& axis, std::vector<std::uint32_t>& near, std::vector<Entry>& row) const {
        near.clear();
        bands_.near(axis, 3 * std::sqrt(4 * kPiDouble / double(dome_.directions.size())), near);
        const std::uint32_t nearest = *std::max_element(near.begin(), near.end(), [&](auto a, auto b) {
            const double dot_a = glm::dot(dome_.directions[a], axis), dot_b = glm::dot(dome_.directions[b], axis);
            return dot_a != dot_b ? dot_a < dot_b : a > b;
        });
        glm::dvec3 best_shares(0);
        glm::uvec3 best_triangle(0);
        double best = -std::numeric_limits<double>::infinity();
        for (std::uint32_t t : triangles_of_[nearest]) {
            const glm::uvec3 triangle = dome_.triangles[t];
            const glm::dvec3 &a = dome_.directions[triangle.x], &b = dome_.directions[triangle.y],
                             &c = dome_.directions[triangle.z];
            glm::dvec3 shares(glm::dot(axis, glm::cross(b, c)), glm::dot(axis, glm::cross(c, a)),
                              glm::dot(axis, glm::cross(a, b)));
            shares /= shares.x + shares.y + shares.z;
            const double least = std::min({shares.x, shares.y, shares.z});
            if (least > best) {
                best = least;
                best_shares = shares;
                best_triangle = triangle;
            }
        }
        best_shares = glm::max(best_shares, glm::dvec3(0));
        best_shares /= best_shares.x + best_shares.y + best_shares.z;
        row.clear();
        for (glm::length_t corner = 0; corner < 3; ++corner)
            row.push_back({best_triangle[corner], best_shares[corner]});
    }

    const GeodesicDome& dome_;
    DirectionBands bands_;
    double blur_; ///< mean of 1 - cosine
    std::vector<std::vector<std::uint32_t>> triangles_of_;
};

Lobe lobe_of(const TexelLayout& layout, std::size_t texel) {
    return {layout.kind, double(layout.parameters[texel])};
}

} // namespace

void WeightTable::find_members(const TexelLayout& layout, std::vector<std::uint32_t>& texel_of_row) {
    const std::size_t texels = layout.size();
    if (texels >= kMostTexels)
        throw InputError("a weight table serves fewer than " + count_text(kMostTexels) + " texels, not " +
                         count_text(texels) + "; make the map smaller, or bake it by the method spectral");
    std::vector<std::uint32_t> row_of_texel(texels), symmetry_of_texel(texels);
    std::unordered_map<RowKey, std::uint32_t, RowKeyHash> rows;
    rows.reserve(texels / 16 + 16);
    for (std::size_t t = 0; t < texels; ++t) {
        const Placed place = placed(layout.directions[t]);
        const auto [found, is_new] =
            rows.try_emplace({place.direction, coarse_bits(layout.parameters[t])}, std::uint32_t(texel_of_row.size()));
        if (is_new)
            texel_of_row.push_back(std::uint32_t(t));
        row_of_texel[t] = found->second;
        symmetry_of_texel[t] = place.symmetry;
    }
    member_starts_.assign(texel_of_row.size() + 1, 0);
    for (std::uint32_t row : row_of_texel)
        ++member_starts_[row + 1];
    for (std::size_t row = 0; row < texel_of_row.size(); ++row)
        member_starts_[row + 1] += member_starts_[row];
    std::vector<std::uint32_t> next(member_starts_.begin(), member_starts_.end() - 1);
    members_.resize(texels);
    for (std::size_t t = 0; t < texels; ++t)
        members_[next[row_of_texel[t]]++] = std::uint32_t(t) * 32 + symmetry_of_texel[t];
}

void WeightTable::fill_rows(const TexelLayout& layout, const TableSettings& settings,
                            const std::vector<std::uint32_t>& texel_of_row, Progress& progress) {
    const std::size_t rows = texel_of_row.size();
    constexpr std::size_t kBlock = 512;
    struct Block {
        std::vector<std::uint32_t> sizes;
        std::vector<std::uint16_t> vertices;
        std::vector<float> weights;
    };
    std::vector<Block> blocks((rows + kBlock - 1) / kBlock);
    levels_.resize(rows);
    std::vector<DomeWeights> domes;
    for (int level = 0; level < kDomeLevels; ++level)
        domes.emplace_back(level);
    progress.begin("table of weights", rows);
    parallel_blocks(rows, kBlock, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        Block& block = blocks[begin / kBlock];
        std::vector<DomeWeights::Entry> row;
        std::vector<std::uint32_t> near;
        for (std::size_t r = begin; r < end; ++r) {
            const std::uint32_t texel = texel_of_row[r];
            const Lobe lobe = lobe_of(layout, texel);
            const Placed place = placed(layout.directions[texel]);
            const int level = level_of(lobe, settings.vertices_a_lobe);
            levels_[r] = std::uint8_t(level);
            domes[std::size_t(level)].find_row(glm::normalize(glm::dvec3(place.direction)), lobe, settings, near, row);
            block.sizes.push_back(std::uint32_t(row.size()));
            for (const DomeWeights::Entry& entry : row) {
                block.vertices.push_back(std::uint16_t(entry.vertex));
                block.weights.push_back(float(entry.weight));
            }
        }
        progress.advance(end - begin);
    });
    std::size_t entries = 0;
    for (const Block& block : blocks)
        entries += block.weights.size();
    starts_.assign(1, 0);
    starts_.reserve(rows + 1);
    slots_.reserve(entries);
    weights_.reserve(entries);
    for (Block& block : blocks) {
        for (std::uint32_t size : block.sizes)
            starts_.push_back(starts_.back() + size);
        slots_.insert(slots_.end(), block.vertices.begin(), block.vertices.end());
        weights_.insert(weights_.end(), block.weights.begin(), block.weights.end());
        block = Block(); // memory of both at once would be twice the table's
    }
}

void WeightTable::use_slots() {
    std::vector<std::uint16_t> slot_of[kDomeLevels];
    for (int level = 0; level < kDomeLevels; ++level)
        slot_of[level].assign(dome_of_level(level).dome.directions.size(), 0);
    const auto each_entry = [&](auto&& work) {
        for (std::size_t row = 0; row < levels_.size(); ++row)
            for (std::uint64_t e = starts_[row]; e < starts_[row + 1]; ++e)
                work(slot_of[levels_[row]], slots_[e]);
    };
    each_entry([](std::vector<std::uint16_t>& marks, std::uint16_t vertex) { marks[vertex] = 1; });
    for (int level = 0; level < kDomeLevels; ++level)
        for (std::size_t v = 0; v < slot_of[level].size(); ++v)
            if (slot_of[level][v]) {
                slot_of[level][v] = std::uint16_t(used_[level].size());
                used_[level].push_back(std::uint16_t(v));
            }
    each_entry([](const std::vector<std::uint16_t>& slots, std::uint16_t& vertex) { vertex = slots[vertex]; });
}

std::uint64_t table_identity(const TexelLayout& layout, const TableSettings& settings) {
    std::uint64_t hash = hash64(std::uint64_t(layout.kind) * 8 + std::uint64_t(settings.weights));
    hash = hash64(hash ^ std::bit_cast<std::uint64_t>(settings.threshold));
    hash = hash64(hash ^ std::bit_cast<std::uint64_t>(settings.vertices_a_lobe));
    hash = hash64(hash ^ layout.size());
    const auto bits = [](float value) { return std::uint64_t(std::bit_cast<std::uint32_t>(value)); };
    for (std::size_t t = 0; t < layout.size(); ++t) {
        const glm::vec3& d = layout.directions[t];
        hash = hash64(hash ^ (bits(d.x) << 32 | bits(d.y)));
        hash = hash64(hash ^ (bits(d.z) << 32 | bits(layout.parameters[t])));
    }
    return hash;
}

WeightTable::WeightTable(const TexelLayout& layout, const TableSettings& settings, Progress& progress) {
    check_settings(settings);
    std::vector<std::uint32_t> texel_of_row;
    find_members(layout, texel_of_row);
    double entries = 0;
    for (std::uint32_t texel : texel_of_row)
        entries += expected_entries(lobe_of(layout, texel), settings);
    const double bytes = 6 * entries + 4.0 * double(layout.size()) + 16.0 * double(texel_of_row.size());
    if (bytes > double(settings.most_bytes))
        throw InputError("the weight table would take " + count_text(std::uint64_t(bytes / 1e6)) + " MB where " +
                         count_text(settings.most_bytes / 1'000'000) +
                         " MB are allowed; give a higher threshold, a smaller map, or the method spectral");
    fill_rows(layout, settings, texel_of_row, progress);
    use_slots();
    for (std::size_t row = 0; row < levels_.size(); ++row)
        unshared_ += (starts_[row + 1] - starts_[row]) * (member_starts_[row + 1] - member_starts_[row]);
    identity_ = table_identity(layout, settings);
}

} // namespace kokage
