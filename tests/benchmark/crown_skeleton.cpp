#include "tests/benchmark/crown_skeleton.h"
#include "common/services/random.h"
#include "tests/benchmark/rounded.h"

#include <algorithm>
#include <cmath>

namespace kokage {

namespace {

constexpr std::uint32_t kLimbs = 16, kBranches = 128;
constexpr double kTrunkRadius = 0.21, kTrunkTop = 9.6;

/// The three-dimensional R sequence (Kronecker sequence of the root of x^4 = x + 1) in 64-bit integers: evenly spread
/// for every number of points, and exact.
class EvenPoints {
  public:
    explicit EvenPoints(std::uint64_t seed) : x_(hash64(seed)), y_(hash64(seed + 1)), z_(hash64(seed + 2)) {}
    /// The next point in [-1, 1)^3.
    glm::dvec3 next() {
        x_ += 0xd1b54a32d192ed03ull;
        y_ += 0xabc98388fb8fac03ull;
        z_ += 0x8cb92ba72f3d8dd7ull;
        return {unit(x_), unit(y_), unit(z_)};
    }

  private:
    static double unit(std::uint64_t x) { return double(x >> 11) * 0x1p-52 - 1.0; }
    std::uint64_t x_, y_, z_;
};

/// Uniform in [0, 1)^3.
glm::dvec3 random_point(Random& random) {
    const double x = random.uniform_double(), y = random.uniform_double();
    return {x, y, random.uniform_double()};
}

/// A place on the skeleton where a finer branch may leave.
struct Site {
    glm::dvec3 position, along; ///< along: unit direction of growth there
    std::int32_t branch;
    std::uint32_t node;
};

/// A skeleton in double while it grows: positions of the nodes and, for each branch, where it left its parent.
struct GrowingBranch {
    std::int32_t parent;
    std::uint32_t parent_node;
    int order;
    std::vector<glm::dvec3> nodes;
};

std::vector<Site> sites_of_order(const std::vector<GrowingBranch>& branches, int order) {
    std::vector<Site> sites;
    for (std::size_t b = 0; b < branches.size(); ++b) {
        const auto& nodes = branches[b].nodes;
        if (branches[b].order != order)
            continue;
        for (std::size_t n = 1; n < nodes.size(); ++n) // not where the branch itself begins
            sites.push_back({nodes[n], glm::normalize(nodes[n] - nodes[n - 1]), std::int32_t(b), std::uint32_t(n)});
    }
    return sites;
}

/// The site from which it is shortest to a tip, with a preference for going on forwards rather than turning back.
const Site& best_site(const std::vector<Site>& sites, const glm::dvec3& tip, double& distance) {
    const Site* best = &sites.front();
    double best_cost = 1e300;
    for (const Site& site : sites) {
        const glm::dvec3 way = tip - site.position;
        const double length = std::sqrt(glm::dot(way, way));
        const double cost = 1.5 * length - 0.5 * glm::dot(site.along, way);
        if (cost < best_cost) {
            best_cost = cost;
            best = &site;
            distance = length;
        }
    }
    return *best;
}

/// A curve that leaves its parent at an angle and bends towards the tip (a quadratic Bezier curve).
GrowingBranch grow_to(const Site& site, const glm::dvec3& tip, int order, int segments, Random& random) {
    GrowingBranch branch{site.branch, site.node, order, {}};
    const glm::dvec3 way = tip - site.position;
    const double length = std::sqrt(glm::dot(way, way));
    const glm::dvec3 wobble = random_point(random) - 0.5;
    const glm::dvec3 control =
        site.position + 0.5 * way + length * (0.15 * site.along + 0.25 * wobble) + glm::dvec3(0.0, 0.06 * length, 0.0);
    for (int i = 0; i <= segments; ++i) {
        const double t = double(i) / segments;
        branch.nodes.push_back((1 - t) * (1 - t) * site.position + 2 * t * (1 - t) * control + t * t * tip);
    }
    return branch;
}

void grow_trunk(std::vector<GrowingBranch>& branches, std::uint64_t seed) {
    Random random(seed, 100);
    GrowingBranch trunk{-1, 0, 0, {}};
    glm::dvec3 position(0.0), lean(0.0);
    constexpr int segments = 24;
    for (int i = 0; i <= segments; ++i) {
        trunk.nodes.push_back(position);
        lean = 0.75 * lean - 0.02 * glm::dvec3(position.x, 0.0, position.z) +
               0.05 * glm::dvec3(random.uniform_double() - 0.5, 0.0, random.uniform_double() - 0.5);
        position += lean + glm::dvec3(0.0, kTrunkTop / segments, 0.0);
    }
    branches.push_back(std::move(trunk));
}

void grow_limbs(std::vector<GrowingBranch>& branches, const CrownEnvelope& envelope, std::uint64_t seed) {
    Random random(seed, 101);
    const std::vector<Site> trunk = sites_of_order(branches, 0);
    double c = 1, s = 0;
    for (std::uint32_t i = 0; i < kLimbs; ++i) {
        const double height = (i + 0.5) / kLimbs;
        const Site& site = trunk[std::size_t((0.24 + 0.72 * height) * double(trunk.size()))];
        const double rise = -0.35 + 1.15 * height + 0.3 * (random.uniform_double() - 0.5);
        const glm::dvec3 tip = envelope.centre + (0.8 + 0.12 * random.uniform_double()) *
                                                     (envelope.surface({c, rise, s}) - envelope.centre);
        Site upwards = site;
        upwards.along = glm::normalize(glm::dvec3(c, 0.9, s));
        branches.push_back(grow_to(upwards, tip, 1, 12, random));
        const double turned = c * kGoldenCos - s * kGoldenSin;
        s = c * kGoldenSin + s * kGoldenCos;
        c = turned;
    }
}

/// How the branches of one order fill the crown.
struct OrderStyle {
    int order;
    std::uint32_t count;
    double inner_level, outer_level; ///< of the envelope: tips get rarer towards the inside, and none lies outside
    double reach;                    ///< metres from wood of the order below
    int segments;
};

/// Foliage grows in clumps: balls around the tips of the branches of order 2.
class Clumps {
  public:
    explicit Clumps(const std::vector<GrowingBranch>& branches) {
        for (const GrowingBranch& branch : branches)
            if (branch.order == 2)
                tips_.push_back(branch.nodes.back());
    }
    bool hold(const glm::dvec3& point) const {
        constexpr double radius = 1.25;
        return tips_.empty() || std::any_of(tips_.begin(), tips_.end(), [&](const glm::dvec3& tip) {
                   return glm::dot(point - tip, point - tip) < radius * radius;
               });
    }

  private:
    std::vector<glm::dvec3> tips_;
};

/// Grows branches towards evenly spread tips inside the clumps, each from the best place of the order below.
void grow_order(std::vector<GrowingBranch>& branches, const CrownEnvelope& envelope, const OrderStyle& style,
                std::uint64_t seed) {
    const std::vector<Site> sites = sites_of_order(branches, style.order - 1);
    const Clumps clumps(branches);
    EvenPoints points(seed + 1000 * std::uint64_t(style.order));
    Random random(seed, 101 + std::uint64_t(style.order));
    // The even points are a lattice; a jitter of about their spacing hides it.
    const double jitter = 1.0 / std::cbrt(double(style.count));
    for (std::uint32_t grown = 0, tried = 0; grown < style.count; ++tried) {
        const glm::dvec3 cube = points.next() + jitter * (2.0 * random_point(random) - 1.0);
        const double half_height = cube.y > 0 ? envelope.half_height_up : envelope.half_height_down;
        const glm::dvec3 tip =
            envelope.centre + 1.2 * cube * glm::dvec3(envelope.half_width, half_height, envelope.half_width);
        const double level = envelope.level(tip);
        if (level > style.outer_level || level < style.inner_level * random.uniform_double() || !clumps.hold(tip))
            continue;
        double distance = 0;
        const Site& site = best_site(sites, tip, distance);
        // Tips out of reach must not stop the loop for ever: after very many tries anything goes.
        const bool reached = distance < style.reach && distance > 0.1 * style.reach;
        if (!reached && tried < 1000 + 50 * style.count)
            continue;
        branches.push_back(grow_to(site, tip, style.order, style.segments, random));
        ++grown;
    }
}

/// Pipe model: every node carries one unit of cross-section for each twig that it feeds.
Skeleton with_radii(const std::vector<GrowingBranch>& branches) {
    std::vector<std::vector<double>> section(branches.size());
    for (std::size_t b = 0; b < branches.size(); ++b)
        section[b].assign(branches[b].nodes.size(), 0.0);
    for (std::size_t b = branches.size(); b-- > 0;) { // children come after their parents
        auto& own = section[b];
        own.back() += 1.0;
        for (std::size_t n = own.size() - 1; n-- > 0;)
            own[n] += own[n + 1];
        if (branches[b].parent >= 0)
            section[std::size_t(branches[b].parent)][branches[b].parent_node] += own[0];
    }
    Skeleton skeleton;
    const double unit_radius = kTrunkRadius / std::sqrt(section[0][0]);
    for (std::size_t b = 0; b < branches.size(); ++b) {
        Branch branch{branches[b].parent, branches[b].order, {}};
        for (std::size_t n = 0; n < branches[b].nodes.size(); ++n)
            branch.nodes.push_back({rounded(branches[b].nodes[n]), float(unit_radius * std::sqrt(section[b][n]))});
        skeleton.branches.push_back(std::move(branch));
    }
    return skeleton;
}

} // namespace

double CrownEnvelope::level(const glm::dvec3& point) const {
    const glm::dvec3 d = point - centre;
    const double y = d.y / (d.y > 0 ? half_height_up : half_height_down);
    return std::sqrt((d.x * d.x + d.z * d.z) / (half_width * half_width) + y * y);
}

glm::dvec3 CrownEnvelope::surface(const glm::dvec3& direction) const {
    return centre + direction / level(centre + direction);
}

Skeleton make_bench_skeleton(std::uint32_t twigs, std::uint64_t seed) {
    const CrownEnvelope envelope;
    std::vector<GrowingBranch> branches;
    grow_trunk(branches, seed);
    grow_limbs(branches, envelope, seed);
    grow_order(branches, envelope, {2, kBranches, 0.8, 0.92, 2.2, 8}, seed);
    if (twigs > 8 * kBranches) { // too many for one order: a finer one in between, in geometric proportion
        const auto between = std::uint32_t(std::sqrt(double(kBranches) * twigs));
        grow_order(branches, envelope, {3, between, 1.0, 1.1, 1.0, 4}, seed);
        grow_order(branches, envelope, {4, twigs, 1.0, 1.12, 0.6, 3}, seed);
    } else {
        grow_order(branches, envelope, {3, twigs, 1.0, 1.12, 1.2, 4}, seed);
    }
    return with_radii(branches);
}

} // namespace kokage
