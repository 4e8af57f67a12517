#include "common/services/error.h"
#include "common/services/random.h"
#include "trees/growth/directions.h"
#include "trees/growth/streams.h"
#include "trees/growth/wood_graph.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Attraction points in the cells of a regular grid, and for each the nearest node found so far.
class AttractionField {
  public:
    AttractionField(const std::vector<glm::vec3>& points, float influence) : points_(points), influence_(influence) {
        low_ = high_ = points.empty() ? glm::vec3(0.f) : points[0];
        for (const glm::vec3& p : points) {
            low_ = glm::min(low_, p);
            high_ = glm::max(high_, p);
        }
        const glm::vec3 extent = high_ - low_;
        // About one point a cell, and never more cells than a few times the points.
        const float volume =
            std::max(extent.x, influence) * std::max(extent.y, influence) * std::max(extent.z, influence);
        cell_ = std::max(influence * 0.25f, std::cbrt(volume / float(2 * points.size() + 8)));
        for (std::size_t k = 0; k < 3; ++k)
            size_[k] = int(extent[k] / cell_) + 1;
        const std::size_t cells = std::size_t(size_.x) * std::size_t(size_.y) * std::size_t(size_.z);
        std::vector<std::uint32_t> cell_of(points.size());
        first_.assign(cells + 1, 0);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const glm::ivec3 c = cell(points[i]);
            cell_of[i] = std::uint32_t((c.z * size_.y + c.y) * size_.x + c.x);
            ++first_[cell_of[i] + 1];
        }
        for (std::size_t c = 0; c < cells; ++c)
            first_[c + 1] += first_[c];
        order_.resize(points.size());
        std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
        for (std::size_t i = 0; i < points.size(); ++i)
            order_[next[cell_of[i]]++] = std::uint32_t(i);
        nearest.assign(points.size(), -1);
        distance.assign(points.size(), influence);
    }

    /// Tells the points around a new node of it.
    void add_node(const glm::vec3& position, std::int32_t node) {
        const glm::ivec3 from = cell(position - influence_), to = cell(position + influence_);
        for (int z = from.z; z <= to.z; ++z)
            for (int y = from.y; y <= to.y; ++y) {
                const std::size_t row = (std::size_t(z) * std::size_t(size_.y) + std::size_t(y)) * std::size_t(size_.x);
                for (std::uint32_t i = first_[row + std::size_t(from.x)]; i < first_[row + std::size_t(to.x) + 1];
                     ++i) {
                    const std::uint32_t point = order_[i];
                    const float d = glm::distance(points_[point], position);
                    if (d < distance[point]) {
                        distance[point] = d;
                        nearest[point] = node;
                    }
                }
            }
    }

    std::vector<std::int32_t> nearest;
    std::vector<float> distance;

  private:
    glm::ivec3 cell(const glm::vec3& p) const {
        return glm::clamp(glm::ivec3(glm::floor((p - low_) / cell_)), glm::ivec3(0), size_ - 1);
    }
    const std::vector<glm::vec3>& points_;
    float influence_, cell_ = 1;
    glm::vec3 low_, high_;
    glm::ivec3 size_{1};
    std::vector<std::uint32_t> first_, order_;
};

} // namespace

void colonise(std::vector<WoodNode>& nodes, const Crown::Attractors& attractors, const GrowthParameters& p, float step,
              float influence, float kill, Progress& progress) {
    const std::vector<glm::vec3>& points = attractors.points;
    AttractionField field(points, influence);
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (nodes[n].may_branch)
            field.add_node(nodes[n].position, std::int32_t(n));
    std::vector<std::uint32_t> alive(points.size());
    for (std::size_t i = 0; i < alive.size(); ++i)
        alive[i] = std::uint32_t(i);
    std::vector<glm::vec3> pull(nodes.size(), glm::vec3(0.f));
    std::vector<glm::vec3> last_child(nodes.size(), glm::vec3(1e30f)), child_before(nodes.size(), glm::vec3(1e30f));
    std::vector<char> is_stuck(nodes.size(), 0);
    const float wander = std::sin(radians(p.branch_zigzag));
    for (int round = 0; round < 4096 && !alive.empty(); ++round) {
        progress.throw_if_stopped();
        // Points that are used up, or pull a node that can't follow, drop out.
        std::erase_if(alive, [&](std::uint32_t i) {
            return field.distance[i] < kill || (field.nearest[i] >= 0 && is_stuck[std::size_t(field.nearest[i])]);
        });
        std::vector<std::int32_t> pulled;
        for (const std::uint32_t i : alive) {
            const std::int32_t node = field.nearest[i];
            if (node < 0)
                continue;
            glm::vec3& sum = pull[std::size_t(node)];
            if (sum == glm::vec3(0.f))
                pulled.push_back(node);
            sum += unit_or(points[i] - nodes[std::size_t(node)].position, glm::vec3(0, 1, 0)) + glm::vec3(0, 1e-9f, 0);
        }
        if (pulled.empty())
            return;
        std::sort(pulled.begin(), pulled.end());
        for (const std::int32_t parent : pulled) {
            const std::size_t at = std::size_t(parent);
            Random random(p.seed, streams::of(streams::branch, nodes.size()));
            const glm::vec3 course = unit_or(pull[at], random_direction(random));
            pull[at] = glm::vec3(0.f);
            const glm::vec3 direction =
                unit_or(course + wander * random_direction(random) + glm::vec3(0, float(p.branch_up), 0), course);
            const glm::vec3 position = nodes[at].position + step * direction;
            // A node between two equal pulls would put out the same step for ever (Runions 2007, section 3).
            if (std::min(glm::distance(position, last_child[at]), glm::distance(position, child_before[at])) <
                0.5f * step) {
                is_stuck[at] = 1;
                continue;
            }
            child_before[at] = last_child[at];
            last_child[at] = position;
            nodes.push_back({position, parent, -1, true});
            pull.emplace_back(0.f);
            last_child.emplace_back(1e30f);
            child_before.emplace_back(1e30f);
            is_stuck.push_back(0);
            field.add_node(position, std::int32_t(nodes.size()) - 1);
        }
    }
}

} // namespace kokage
