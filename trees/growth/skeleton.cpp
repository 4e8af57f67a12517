#include "trees/growth/skeleton.h"

#include "common/services/random.h"
#include "trees/growth/directions.h"
#include "trees/growth/leaf_shape.h"
#include "trees/growth/streams.h"
#include "trees/growth/young_tree.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Children of every node, in index order: first_child / next_sibling lists.
struct Children {
    std::vector<std::int32_t> first, next;

    explicit Children(const std::vector<WoodNode>& nodes) : first(nodes.size(), -1), next(nodes.size(), -1) {
        for (std::size_t i = nodes.size(); i-- > 0;)
            if (nodes[i].parent >= 0) {
                next[i] = first[std::size_t(nodes[i].parent)];
                first[std::size_t(nodes[i].parent)] = std::int32_t(i);
            }
    }
};

/// Shares `total` whole things out in proportion to weights, exactly.
std::vector<std::uint32_t> share_out(std::uint32_t total, const std::vector<double>& weights) {
    double sum = 0, so_far = 0;
    for (const double w : weights)
        sum += w;
    std::vector<std::uint32_t> shares(weights.size(), 0);
    std::uint32_t given = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        so_far += weights[i];
        const bool last = i + 1 == weights.size();
        const std::uint32_t until =
            last ? total : std::min(total, std::uint32_t(std::floor(so_far / sum * total + 0.5)));
        shares[i] = until - std::min(given, until);
        given = std::max(given, until);
    }
    return shares;
}

/// A unit vector turned towards straight down by an angle, no farther than that.
glm::vec3 turned_down(const glm::vec3& direction, float angle) {
    const float to_down = std::acos(std::clamp(-direction.y, -1.f, 1.f)), turn = std::min(angle, to_down);
    const glm::vec3 across = unit_or(glm::vec3(0, -1, 0) + direction.y * direction, {1, 0, 0});
    return std::cos(turn) * direction + std::sin(turn) * across;
}

/// Nothing hangs lower than this share of the tree's height.
constexpr float lowest_share = 0.025f;
/// On a small tree twigs are too short to bend by their weight: sag is counted by this length at least.
constexpr float least_sagging_m = 0.5f;
/// Wood up to so many shoot radii thick bears the fine twigs of a bare tree.
constexpr float bearing_stoutness = 6;
/// A hanging shoot's length over the longest that it could have, on average.
constexpr double mean_hanging_share = 0.75;

/// How many steps each node lies from the farthest end that it bears.
std::vector<int> steps_to_end(const std::vector<WoodNode>& nodes) {
    std::vector<int> steps(nodes.size(), 0);
    for (std::size_t i = nodes.size(); i-- > 1;)
        if (nodes[i].parent >= 0)
            steps[std::size_t(nodes[i].parent)] = std::max(steps[std::size_t(nodes[i].parent)], steps[i] + 1);
    return steps;
}

class SkeletonBuilder {
  public:
    SkeletonBuilder(std::vector<WoodNode> nodes, const SkyLight& light, double height_m, const GrowthParameters& p)
        : nodes_(std::move(nodes)), light_(light), height_m_(float(height_m)), p_(p), children_(nodes_) {
        place_shoots();
        measure();
        for (int pass = 0; pass < 2; ++pass)
            smooth();
        sag();
        for (WoodNode& node : nodes_) // wood that would grow into the ground creeps along it
            node.position = above_ground(node.position);
    }

    GrownSkeleton build() {
        struct Start {
            std::int32_t node, parent_branch;
            int order;
        };
        // Depth first, parents before children.
        std::vector<Start> pending{{0, -1, 0}};
        while (!pending.empty()) {
            const Start start = pending.back();
            pending.pop_back();
            const std::int32_t index = std::int32_t(result_.skeleton.branches.size());
            result_.skeleton.branches.push_back({start.parent_branch, start.order, {}});
            Branch branch{start.parent_branch, start.order, {}};
            if (start.parent_branch >= 0)
                branch.nodes.push_back(
                    {nodes_[std::size_t(nodes_[std::size_t(start.node)].parent)].position, radius(start.node)});
            std::vector<Start> forks;
            std::int32_t node = start.node;
            for (;;) {
                branch.nodes.push_back({nodes_[std::size_t(node)].position, radius(node)});
                const std::int32_t next = main_child(node);
                for (std::int32_t c = children_.first[std::size_t(node)]; c >= 0; c = children_.next[std::size_t(c)])
                    if (c != next && load_[std::size_t(c)] > 0)
                        forks.push_back({c, index, start.order + 1});
                if (next < 0)
                    break;
                add_side_shoots(node, 0, index, start.order);
                node = next;
            }
            finish_with_shoots(branch, node, index, start.order);
            result_.skeleton.branches[std::size_t(index)] = std::move(branch);
            pending.insert(pending.end(), forks.rbegin(), forks.rend());
        }
        order_side_shoots();
        if (is_bare(p_))
            add_bare_twigs();
        share_leaves();
        return std::move(result_);
    }

  private:
    struct SideShoot {
        std::int32_t branch;
        int order;
        glm::vec3 from, direction;
        std::uint64_t key;
    };

    void place_shoots() {
        const std::vector<int> steps = steps_to_end(nodes_);
        static constexpr double weight_of_step[] = {3.0, 1.2, 0.8, 0.4};
        std::vector<double> weights;
        std::vector<std::size_t> where;
        for (std::size_t i = 0; i < nodes_.size(); ++i)
            if (steps[i] < 4 && nodes_[i].may_branch) {
                where.push_back(i);
                weights.push_back(weight_of_step[steps[i]]);
            }
        if (where.empty()) { // a seedling without a branch
            where.push_back(nodes_.size() - 1);
            weights.push_back(1);
        }
        shed(where, weights);
        const std::uint32_t shoots =
            std::uint32_t(std::clamp(std::round(p_.leaves / leaves_on_a_shoot(p_, height_m_)), 1.0, double(p_.leaves)));
        const std::vector<std::uint32_t> shares = share_out(shoots, weights);
        shoots_on_.assign(nodes_.size(), 0);
        for (std::size_t i = 0; i < where.size(); ++i)
            shoots_on_[where[i]] = shares[i];
        if (youth(p_) > 0)
            keep_leader();
    }

    /// A young tree's stem ends in a shoot: without one its top would be dropped. The twig that has most gives it.
    void keep_leader() {
        std::size_t top = 0;
        for (std::size_t i = 0; i < nodes_.size(); ++i)
            if (nodes_[i].axis == 0)
                top = i;
        const auto giver = std::max_element(shoots_on_.begin(), shoots_on_.end());
        if (shoots_on_[top] > 0 || *giver == 0)
            return;
        --*giver;
        ++shoots_on_[top];
    }

    /// Twigs that get less light than the species can live on bear no shoots: their wood is dropped. The one with most
    /// light always lives.
    void shed(const std::vector<std::size_t>& where, std::vector<double>& weights) const {
        if (p_.light_need <= 0)
            return;
        std::size_t brightest = 0;
        float most = -1;
        for (std::size_t i = 0; i < where.size(); ++i) {
            const float light = light_.relative(nodes_[where[i]].position);
            if (light > most) {
                most = light;
                brightest = i;
            }
            if (double(light) < p_.light_need)
                weights[i] = 0;
        }
        weights[brightest] = std::max(weights[brightest], 0.4);
    }

    /// Thin wood bends down under its load, more the farther it is from thick wood; the leader stands.
    void sag() {
        if (p_.twig_sag <= 0)
            return;
        std::vector<glm::vec3> bent(nodes_.size());
        std::vector<float> thin_m(nodes_.size(), 0.f); ///< length of thin wood up to here
        constexpr float thin_below = 7;                ///< shoot radii
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            bent[i] = nodes_[i].position;
            if (nodes_[i].parent < 0)
                continue;
            const std::size_t parent = std::size_t(nodes_[i].parent);
            const glm::vec3 step = nodes_[i].position - nodes_[parent].position;
            const float length = glm::length(step);
            const float thinness =
                std::clamp(1 - radius(std::int32_t(i)) / float(p_.shoot_radius) / thin_below, 0.f, 1.f);
            thin_m[i] = thin_m[parent] + thinness * length;
            if (nodes_[i].axis == 0) {
                thin_m[i] = 0;
                bent[i] = bent[parent] + step;
                continue;
            }
            const float angle = radians(p_.twig_sag) * thin_m[i] / std::max(0.1f * height_m_, least_sagging_m);
            glm::vec3 direction = turned_down(unit_or(step, {0, 1, 0}), angle);
            if (angle > 0 && bent[parent].y + length * direction.y < lowest_share * height_m_) // along the ground
                direction = unit_or({direction.x, 0, direction.z}, {1, 0, 0});
            bent[i] = bent[parent] + length * direction;
        }
        for (std::size_t i = 0; i < nodes_.size(); ++i)
            nodes_[i].position = bent[i];
    }

    void measure() {
        load_.assign(nodes_.size(), 0);
        for (std::size_t i = nodes_.size(); i-- > 0;) {
            load_[i] += shoots_on_[i];
            if (nodes_[i].parent >= 0)
                load_[std::size_t(nodes_[i].parent)] += load_[i];
        }
    }

    /// Draws every node half of the way to the middle between its neighbours: steps become curves, knees stay.
    void smooth() {
        std::vector<glm::vec3> smoothed(nodes_.size());
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            smoothed[i] = nodes_[i].position;
            const std::int32_t next = main_child(std::int32_t(i));
            if (nodes_[i].parent >= 0 && next >= 0)
                smoothed[i] = 0.5f * nodes_[i].position + 0.25f * (nodes_[std::size_t(nodes_[i].parent)].position +
                                                                   nodes_[std::size_t(next)].position);
        }
        for (std::size_t i = 0; i < nodes_.size(); ++i)
            nodes_[i].position = smoothed[i];
    }

    /// Pipe model: every shoot below counts with radius^e.
    float radius(std::int32_t node) const {
        return float(p_.shoot_radius * std::pow(std::max(1.0, load_[std::size_t(node)]), 1 / p_.pipe_exponent));
    }

    /// The child that goes on as the same branch: the one that bears most, unless it turns off sharply.
    std::int32_t main_child(std::int32_t node) const {
        std::int32_t best = -1;
        double best_score = -1;
        for (std::int32_t c = children_.first[std::size_t(node)]; c >= 0; c = children_.next[std::size_t(c)]) {
            if (load_[std::size_t(c)] <= 0)
                continue;
            if (nodes_[std::size_t(node)].axis >= 0 && nodes_[std::size_t(c)].axis == nodes_[std::size_t(node)].axis)
                return c;
            const double straightness = std::max(0.f, glm::dot(direction_at(node), direction_at(c)));
            const double score = load_[std::size_t(c)] * (0.25 + straightness);
            if (score > best_score) {
                best = c;
                best_score = score;
            }
        }
        return best;
    }

    glm::vec3 direction_at(std::int32_t node) const {
        const WoodNode& n = nodes_[std::size_t(node)];
        return n.parent < 0 ? glm::vec3(0, 1, 0)
                            : unit_or(n.position - nodes_[std::size_t(n.parent)].position, {0, 1, 0});
    }

    void add_side_shoots(std::int32_t node, std::uint32_t first, std::int32_t branch, int order) {
        const glm::vec3 along = direction_at(node), from = nodes_[std::size_t(node)].position;
        for (std::uint32_t k = first; k < shoots_on_[std::size_t(node)]; ++k) {
            const std::uint64_t key = (std::uint64_t(node) << 8) + k;
            Random random(p_.seed, streams::of(streams::shoot, key));
            const float angle = radians(p_.shoot_angle) * random.uniform(0.6f, 1.4f);
            const float azimuth = shoot_azimuth(along, node, k) + random.uniform(-0.5f, 0.5f);
            const glm::vec3 out = tilted(along, angle, azimuth);
            side_shoots_.push_back(
                {branch, order + 1, from, unit_or(out + glm::vec3(0, 2 * float(p_.shoot_up), 0), out), key});
        }
    }

    /// Where around its twig the k-th shoot of a node stands: as buds in leaves' axils do.
    float shoot_azimuth(const glm::vec3& along, std::int32_t node, std::uint32_t k) const {
        if (p_.leaf_arrangement == LeafArrangement::distichous) { // left and right, as tilted() counts its angles
            const glm::vec3 left = unit_or(glm::cross(glm::vec3(0, 1, 0), along), {1, 0, 0});
            const glm::vec3 x = any_perpendicular(along), y = glm::cross(along, x);
            return std::atan2(glm::dot(left, y), glm::dot(left, x)) + kPi * float(k + std::uint32_t(node));
        }
        if (p_.leaf_arrangement == LeafArrangement::opposite)
            return kPi * float(k) + 0.5f * kPi * float(std::uint32_t(node) + k / 2);
        return 2.39996323f * float(k) + 1.3f * float(node);
    }

    glm::vec3 above_ground(const glm::vec3& position) const {
        return {position.x, position.y < 0 ? 0.003f * height_m_ : position.y, position.z};
    }

    /// Appends the nodes of a shoot that runs from the last node of `branch`, bending upwards a little, or hanging.
    void grow_shoot(Branch& branch, glm::vec3 direction, std::uint64_t key) {
        Random random(p_.seed, streams::of(streams::shoot, key + (1ull << 40)));
        const std::uint32_t first_node = std::uint32_t(branch.nodes.size()) - 1;
        const float radius_m = float(p_.shoot_radius);
        float length = float(p_.shoot_length) * random.uniform(0.6f, 1.4f);
        const float hanging = float(p_.shoot_hang) * height_m_ * random.uniform(0.5f, 1.f);
        glm::vec3 position = branch.nodes.back().position;
        if (hanging > length) {
            // Down to a little above the ground, not all to the same height.
            length = std::min(hanging, std::max(length, position.y - height_m_ * random.uniform(lowest_share, 0.12f)));
            constexpr int pieces = 6;
            for (int i = 0; i < pieces; ++i) {
                direction = unit_or(direction + 0.1f * random_direction(random) - glm::vec3(0, 0.55f, 0), direction);
                position += length / float(pieces) * direction;
                position.y = std::max(position.y, lowest_share * height_m_);
                branch.nodes.push_back({position, radius_m * (1 - 0.5f * float(i + 1) / float(pieces))});
            }
        } else {
            for (int i = 0; i < 2; ++i) {
                direction = unit_or(direction + 0.2f * random_direction(random) + glm::vec3(0, float(p_.shoot_up), 0),
                                    direction);
                position = above_ground(position + 0.5f * length * direction);
                branch.nodes.push_back({position, radius_m * (i == 0 ? 0.85f : 0.5f)});
            }
        }
        result_.shoots.push_back({-1, first_node, 0, 0});
        shoot_lengths_.push_back(length);
    }

    /// The end of a branch: its first shoot continues it, the others stand around it.
    void finish_with_shoots(Branch& branch, std::int32_t node, std::int32_t index, int order) {
        if (shoots_on_[std::size_t(node)] > 0) {
            grow_shoot(branch, direction_at(node), std::uint64_t(node) << 8);
            result_.shoots.back().branch = index;
        }
        add_side_shoots(node, 1, index, order);
    }

    /// Side shoots become branches after all others: parents still come first.
    void order_side_shoots() {
        for (const SideShoot& side : side_shoots_) {
            Branch branch{side.branch, side.order, {{side.from, float(p_.shoot_radius)}}};
            grow_shoot(branch, side.direction, side.key);
            result_.shoots.back().branch = std::int32_t(result_.skeleton.branches.size());
            result_.skeleton.branches.push_back(std::move(branch));
        }
    }

    /// Side twigs of shoots and thin wood, which leaves hide: what makes a bare crown a haze instead of a rake. A
    /// hanging shoot has as many more as it is longer, and they hang.
    void add_bare_twigs() {
        const std::size_t branches = result_.skeleton.branches.size();
        for (std::size_t b = 0; b < branches; ++b) {
            Random random(p_.seed, streams::of(streams::shoot, b + (1ull << 42)));
            for (std::size_t n = 1; n + 1 < result_.skeleton.branches[b].nodes.size(); ++n) {
                const float stoutness = result_.skeleton.branches[b].nodes[n].radius_m / float(p_.shoot_radius);
                const int twigs = stoutness > 1 && stoutness < bearing_stoutness
                                      ? int(0.5 * p_.bare_twigs + double(random.uniform()))
                                      : 0;
                for (int k = 0; k < twigs; ++k)
                    add_bare_twig(std::int32_t(b), n, k, random);
            }
        }
        for (std::size_t s = 0; s < result_.shoots.size(); ++s) {
            const Shoot shoot = result_.shoots[s];
            Random random(p_.seed, streams::of(streams::shoot, s + (1ull << 41)));
            const double wanted =
                p_.bare_twigs * std::max(1.0, double(shoot_lengths_[s]) / (2 * p_.shoot_length)) + random.uniform();
            const std::size_t steps =
                result_.skeleton.branches[std::size_t(shoot.branch)].nodes.size() - 1 - shoot.first_node;
            for (int k = 0; k + 1 <= int(wanted); ++k) {
                const std::size_t node =
                    shoot.first_node + std::min(steps - 1, std::size_t(random.uniform() * float(steps)));
                add_bare_twig(shoot.branch, node, k, random);
            }
        }
    }

    void add_bare_twig(std::int32_t bearer, std::size_t node, int k, Random& random) {
        const Branch& bearing = result_.skeleton.branches[std::size_t(bearer)];
        const glm::vec3 from = bearing.nodes[node].position;
        const glm::vec3 along = unit_or(bearing.nodes[node + 1].position - from, {0, 1, 0});
        const float angle = radians(p_.shoot_angle) * random.uniform(0.6f, 1.3f);
        glm::vec3 direction = tilted(
            along, angle, shoot_azimuth(along, std::int32_t(node), std::uint32_t(k)) + random.uniform(-0.7f, 0.7f));
        const float length = float(p_.shoot_length) * random.uniform(0.5f, 1.8f),
                    radius_m = std::min(0.5f * float(p_.shoot_radius), 0.9f * bearing.nodes[node].radius_m);
        // Straight: one cone, for there are several times as many as all other branches.
        direction =
            unit_or(direction + glm::vec3(0, p_.shoot_hang > 0 ? -0.8f : 1.5f * float(p_.shoot_up), 0), direction);
        Branch twig{bearer, bearing.order + 1, {{from, radius_m}}};
        twig.nodes.push_back({above_ground(from + length * direction), 0.5f * radius_m});
        result_.skeleton.branches.push_back(std::move(twig));
    }

    void share_leaves() {
        std::vector<double> weights;
        for (std::size_t i = 0; i < result_.shoots.size(); ++i)
            weights.push_back(Random(p_.seed, streams::of(streams::leaf, i + (1ull << 40))).uniform(0.6f, 1.4f) *
                              (p_.shoot_hang > 0 ? shoot_lengths_[i] : 1.f));
        const std::vector<std::uint32_t> shares = share_out(std::uint32_t(p_.leaves), weights);
        std::uint32_t first = 0;
        for (std::size_t i = 0; i < result_.shoots.size(); ++i) {
            result_.shoots[i].first_leaf = first;
            result_.shoots[i].leaf_count = shares[i];
            first += shares[i];
        }
    }

    std::vector<WoodNode> nodes_;
    const SkyLight& light_;
    float height_m_;
    const GrowthParameters& p_;
    Children children_;
    std::vector<std::uint32_t> shoots_on_;
    std::vector<double> load_; ///< shoots that a node bears
    std::vector<SideShoot> side_shoots_;
    std::vector<float> shoot_lengths_;
    GrownSkeleton result_;
};

} // namespace

double leaves_on_a_shoot(const GrowthParameters& p, double height_m) {
    return p.leaves_per_shoot * std::max(1.0, mean_hanging_share * p.shoot_hang * height_m / p.shoot_length);
}

GrownSkeleton make_skeleton(std::vector<WoodNode> nodes, const SkyLight& light, double height_m,
                            const GrowthParameters& parameters) {
    return SkeletonBuilder(std::move(nodes), light, height_m, parameters).build();
}

} // namespace kokage
