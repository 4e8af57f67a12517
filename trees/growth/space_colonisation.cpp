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

/// What is known of a node while the wood grows.
struct Bud {
    glm::vec3 direction;       ///< of the step that led here
    glm::vec3 pull{0.f};       ///< sum of the pulls of this round
    std::int32_t children = 0; ///< steps that set out from here
    std::int32_t born = 0;     ///< round
    glm::vec3 last_child{1e30f}, child_before{1e30f};
    bool is_stuck = false;
};

/// At most so many steps set out from a node: the axis goes on, and two branches leave it.
constexpr std::int32_t most_children = 3;

class Colonisation {
  public:
    Colonisation(std::vector<WoodNode>& nodes, const std::vector<glm::vec3>& points, const SkyLight& light,
                 const GrowthParameters& p, const ColonisationScale& scale)
        : nodes_(nodes), points_(points), light_(light), p_(p), scale_(scale), field_(points, scale.influence),
          straightness_(0.8f * float(p.apical_dominance)), wander_(std::sin(radians(p.branch_zigzag))),
          held_back_(int(std::lround(8 * p.apical_dominance))) {
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            const std::int32_t parent = nodes[n].parent;
            buds_.push_back({parent < 0 ? glm::vec3(0, 1, 0)
                                        : unit_or(nodes[n].position - nodes[std::size_t(parent)].position, {0, 1, 0})});
            buds_.back().born = -held_back_;
            if (parent >= 0)
                ++buds_[std::size_t(parent)].children;
            if (nodes[n].may_branch)
                field_.add_node(nodes[n].position, std::int32_t(n));
        }
    }

    void grow(Progress& progress) {
        std::vector<std::uint32_t> alive(points_.size());
        for (std::size_t i = 0; i < alive.size(); ++i)
            alive[i] = std::uint32_t(i);
        std::vector<std::int32_t> pulled;
        for (int round = 0; round < 4096 && !alive.empty(); ++round) {
            progress.throw_if_stopped();
            // Points that are used up, or pull a node that can't follow, drop out.
            std::erase_if(alive, [&](std::uint32_t i) {
                const std::int32_t node = field_.nearest[i];
                return field_.distance[i] < scale_.kill || (node >= 0 && buds_[std::size_t(node)].is_stuck);
            });
            pulled.clear();
            for (const std::uint32_t i : alive) {
                const std::int32_t node = field_.nearest[i];
                if (node < 0)
                    continue;
                glm::vec3& sum = buds_[std::size_t(node)].pull;
                if (sum == glm::vec3(0.f))
                    pulled.push_back(node);
                sum += unit_or(points_[i] - nodes_[std::size_t(node)].position, {0, 1, 0}) + glm::vec3(0, 1e-9f, 0);
            }
            if (pulled.empty())
                return;
            std::sort(pulled.begin(), pulled.end());
            for (const std::int32_t node : pulled)
                extend(std::size_t(node), round);
        }
    }

  private:
    void extend(std::size_t at, int round) {
        const glm::vec3 pull = buds_[at].pull;
        buds_[at].pull = glm::vec3(0.f);
        const bool is_lateral = buds_[at].children > 0;
        if (is_lateral && round - buds_[at].born < held_back_)
            return; // the end of the axis is too near
        Random random(p_.seed, streams::of(streams::branch, nodes_.size()));
        const glm::vec3 along = buds_[at].direction, course = unit_or(pull, random_direction(random));
        glm::vec3 direction = is_lateral ? leave_axis(along, course, random)
                                         : unit_or((1 - straightness_) * course + straightness_ * along, course);
        const glm::vec3 tropism =
            glm::vec3(0, float(p_.branch_up), 0) +
            (p_.branch_to_light > 0 ? float(p_.branch_to_light) * light_.direction(nodes_[at].position)
                                    : glm::vec3(0.f));
        direction =
            unit_or(direction + wander_ * random_direction(random) + (is_lateral ? 0.3f : 1.f) * tropism, course);
        const glm::vec3 position = nodes_[at].position + scale_.step * direction;
        // A node between two equal pulls would put out the same step for ever (Runions 2007, section 3).
        if (buds_[at].children >= most_children ||
            std::min(glm::distance(position, buds_[at].last_child), glm::distance(position, buds_[at].child_before)) <
                0.5f * scale_.step) {
            buds_[at].is_stuck = true;
            return;
        }
        add_step(at, direction, round);
        // Buds in pairs put out branches in pairs; the one that finds no room stays a short shoot.
        if (is_lateral && p_.leaf_arrangement == LeafArrangement::opposite)
            add_step(at, unit_or(2 * glm::dot(direction, along) * along - direction, along), round);
    }

    void add_step(std::size_t at, const glm::vec3& direction, int round) {
        const glm::vec3 position = nodes_[at].position + scale_.step * direction;
        buds_[at].child_before = buds_[at].last_child;
        buds_[at].last_child = position;
        ++buds_[at].children;
        nodes_.push_back({position, std::int32_t(at), -1, true});
        buds_.push_back({direction});
        buds_.back().born = round;
        field_.add_node(position, std::int32_t(nodes_.size()) - 1);
    }

    /// The first step of a branch: at the branching angle from the axis, on the side of its pull.
    glm::vec3 leave_axis(const glm::vec3& along, const glm::vec3& course, Random& random) const {
        glm::vec3 out = unit_or(course - glm::dot(course, along) * along, any_perpendicular(along));
        if (p_.leaf_arrangement == LeafArrangement::distichous) { // buds left and right: branches lie in level sprays
            const glm::vec3 left = unit_or(glm::cross(glm::vec3(0, 1, 0), along), out);
            out = unit_or((glm::dot(out, left) < 0 ? -1.f : 1.f) * left + 0.4f * out, out);
        }
        const float angle = radians(p_.branch_angle + p_.branch_angle_spread * double(random.uniform(-1.f, 1.f)));
        return std::cos(angle) * along + std::sin(angle) * out;
    }

    std::vector<WoodNode>& nodes_;
    const std::vector<glm::vec3>& points_;
    const SkyLight& light_;
    const GrowthParameters& p_;
    ColonisationScale scale_;
    AttractionField field_;
    std::vector<Bud> buds_;
    float straightness_, wander_;
    int held_back_; ///< rounds that a bud waits before it grows out beside its axis
};

} // namespace

void colonise(std::vector<WoodNode>& nodes, const std::vector<glm::vec3>& points, const SkyLight& light,
              const GrowthParameters& parameters, const ColonisationScale& scale, Progress& progress) {
    Colonisation(nodes, points, light, parameters, scale).grow(progress);
}

} // namespace kokage
