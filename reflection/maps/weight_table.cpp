// How a weight table is used: eq 14 of [R].
#include "reflection/maps/weight_table.h"
#include "common/services/error.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace kokage {

namespace {

constexpr std::size_t kChannels = 3, kValues = kDomeSymmetries * kChannels;
/// Rows with as many members or more are summed for all symmetries at once.
constexpr std::uint32_t kManyMembers = 6;

/// For every vertex in use, the radiance at its 24 symmetric vertices side by side.
std::vector<float> symmetric_light(const Dome& dome, std::span<const std::uint16_t> used,
                                   std::span<const glm::vec3> radiance) {
    std::vector<float> values(used.size() * kValues);
    parallel_blocks(used.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slot = begin; slot < end; ++slot)
            for (std::size_t symmetry = 0; symmetry < kDomeSymmetries; ++symmetry) {
                const glm::vec3& light = radiance[dome.vertex_of[symmetry][used[slot]]];
                float* value = &values[slot * kValues + symmetry * kChannels];
                value[0] = light.x;
                value[1] = light.y;
                value[2] = light.z;
            }
    });
    return values;
}

/// sums[0..71] = sum of weights[e] * light of slots[e].
void sum_all_symmetries(std::span<const std::uint16_t> slots, std::span<const float> weights, const float* light,
                        float* sums) {
    // In parts that fit into registers, each a pass over the row, whose light is in the nearest cache by then.
    constexpr std::size_t kPart = 24;
    for (std::size_t part = 0; part < kValues; part += kPart) {
        float sum[kPart] = {};
        for (std::size_t e = 0; e < slots.size(); ++e) {
            const float* value = light + slots[e] * kValues + part;
            const float weight = weights[e];
            for (std::size_t k = 0; k < kPart; ++k)
                sum[k] += weight * value[k];
        }
        std::copy_n(sum, kPart, sums + part);
    }
}

glm::vec3 sum_one_symmetry(std::span<const std::uint16_t> slots, std::span<const float> weights, const float* light,
                           std::size_t symmetry) {
    glm::vec3 sum(0.f);
    for (std::size_t e = 0; e < slots.size(); ++e) {
        const float* value = light + slots[e] * kValues + symmetry * kChannels;
        sum += weights[e] * glm::vec3(value[0], value[1], value[2]);
    }
    return sum;
}

} // namespace

TableWeights table_weights_from_name(std::string_view name) {
    for (const auto& [known, weights] :
         {std::pair("matched", TableWeights::matched), std::pair("renormalised", TableWeights::renormalised),
          std::pair("paper", TableWeights::paper)})
        if (name == known)
            return weights;
    throw InputError("there are no weights called '" + std::string(name) +
                     "'; there are: matched, renormalised, paper");
}

void WeightTable::filter(const DomeLight& light, std::span<glm::vec3> filtered, Progress& progress) const {
    if (filtered.size() != texels())
        throw std::invalid_argument("as many places as the table has texels are needed");
    std::vector<float> symmetric[kDomeLevels];
    for (int level = 0; level < kDomeLevels; ++level)
        symmetric[level] = symmetric_light(dome_of_level(level), used_[level], light[std::size_t(level)]);
    progress.begin("filtering by the table", levels_.size());
    parallel_blocks(levels_.size(), 2048, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t row = begin; row < end; ++row) {
            const std::size_t first = starts_[row], count = starts_[row + 1] - first;
            const std::span slots = std::span(slots_).subspan(first, count);
            const std::span weights = std::span(weights_).subspan(first, count);
            const float* values = symmetric[levels_[row]].data();
            const std::span members =
                std::span(members_).subspan(member_starts_[row], member_starts_[row + 1] - member_starts_[row]);
            float sums[kValues];
            const bool many = members.size() >= kManyMembers;
            if (many)
                sum_all_symmetries(slots, weights, values, sums);
            for (std::uint32_t member : members) {
                const std::size_t symmetry = member % 32;
                const float* sum = sums + symmetry * kChannels;
                filtered[member / 32] =
                    many ? glm::vec3(sum[0], sum[1], sum[2]) : sum_one_symmetry(slots, weights, values, symmetry);
            }
        }
        progress.advance(end - begin);
    });
}

std::uint64_t WeightTable::bytes() const {
    std::uint64_t used = 0;
    for (const std::vector<std::uint16_t>& level : used_)
        used += level.size();
    return starts_.size() * sizeof(starts_[0]) + member_starts_.size() * sizeof(member_starts_[0]) + levels_.size() +
           members_.size() * sizeof(members_[0]) + slots_.size() * sizeof(slots_[0]) +
           weights_.size() * sizeof(weights_[0]) + used * sizeof(used_[0][0]);
}

} // namespace kokage
