#include "trees/growth/tube.h"

#include "trees/growth/directions.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kokage {
namespace {

int sides_of(float radius) {
    return std::clamp(int(std::lround(3 + 48 * std::pow(radius, 0.75f))), 3, 40);
}

float distance_to_segment(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b) {
    const glm::vec3 ab = b - a;
    const float square = glm::dot(ab, ab);
    const float t = square > 0 ? std::clamp(glm::dot(p - a, ab) / square, 0.f, 1.f) : 0.f;
    return glm::distance(p, a + t * ab);
}

/// Douglas-Peucker: marks the nodes that are needed to stay within a share of the radius.
void mark_needed(const std::vector<Branch::Node>& nodes, std::size_t first, std::size_t last,
                 std::vector<char>& needed) {
    float worst = 1.f;
    std::size_t at = first;
    for (std::size_t i = first + 1; i < last; ++i) {
        const float tolerance = std::max((nodes[i].radius_m > 0.01f ? 0.2f : 0.35f) * nodes[i].radius_m, 0.001f);
        const float excess =
            distance_to_segment(nodes[i].position, nodes[first].position, nodes[last].position) / tolerance;
        if (excess > worst) {
            worst = excess;
            at = i;
        }
    }
    if (at == first)
        return;
    needed[at] = 1;
    mark_needed(nodes, first, at, needed);
    mark_needed(nodes, at, last, needed);
}

/// Catmull-Rom through four points.
glm::vec3 spline(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d, float t) {
    return 0.5f *
           (2.f * b + (c - a) * t + (2.f * a - 5.f * b + 4.f * c - d) * t * t + (3.f * (b - c) + d - a) * t * t * t);
}

struct Point {
    glm::vec3 position;
    float radius;
};

/// The centre line: needed nodes, with points between them on thick wood so that its bends are round.
std::vector<Point> centre_line(const std::vector<Branch::Node>& nodes) {
    std::vector<char> needed(nodes.size(), 0);
    needed.front() = needed.back() = 1;
    mark_needed(nodes, 0, nodes.size() - 1, needed);
    std::vector<Point> points;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (needed[i])
            points.push_back({nodes[i].position, nodes[i].radius_m});
    std::vector<Point> line;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        const Point &a = points[i == 0 ? 0 : i - 1], &b = points[i], &c = points[i + 1],
                    &d = points[std::min(i + 2, points.size() - 1)];
        const float length = glm::distance(b.position, c.position);
        const float spacing = (b.radius > 0.05f ? 2.5f : 5.f) * std::max(b.radius, 0.012f);
        const int pieces = std::clamp(int(length / spacing), 1, 64);
        for (int k = 0; k < (b.radius > 0.01f ? pieces : 1); ++k) {
            const float t = float(k) / float(pieces);
            line.push_back(
                {spline(a.position, b.position, c.position, d.position, t), b.radius + t * (c.radius - b.radius)});
        }
    }
    line.push_back(points.back());
    return line;
}

/// Adds a point to the line at a distance from its start, unless there is one close by or the line is shorter.
void insert_at(std::vector<Point>& line, float distance) {
    float before = 0;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const float length = glm::distance(line[i].position, line[i + 1].position);
        if (distance < before + length) {
            const float t = (distance - before) / length, near = 0.3f * line[i].radius;
            if (distance - before > near && before + length - distance > near)
                line.insert(line.begin() + std::ptrdiff_t(i) + 1, {glm::mix(line[i].position, line[i + 1].position, t),
                                                                   glm::mix(line[i].radius, line[i + 1].radius, t)});
            return;
        }
        before += length;
    }
}

std::vector<Ring> rings_along(const std::vector<Point>& line, bool flat_start) {
    std::vector<Ring> rings;
    float length = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const glm::vec3 before = i > 0 ? unit_or(line[i].position - line[i - 1].position, {0, 1, 0}) : glm::vec3(0.f);
        const glm::vec3 after =
            i + 1 < line.size() ? unit_or(line[i + 1].position - line[i].position, {0, 1, 0}) : glm::vec3(0.f);
        Ring ring;
        ring.centre = line[i].position;
        ring.along = i == 0 && flat_start ? glm::vec3(0, 1, 0) : unit_or(before + after, i > 0 ? before : after);
        length += i > 0 ? glm::distance(line[i].position, line[i - 1].position) : 0.f;
        ring.from_start_m = length;
        ring.radius_m = line[i].radius;
        ring.sides = sides_of(ring.radius_m);
        if (i == 0) {
            ring.x = any_perpendicular(ring.along);
        } else { // parallel transport: the frame turns no more than the line does
            ring.x = unit_or(rings.back().x - glm::dot(rings.back().x, ring.along) * ring.along,
                             any_perpendicular(ring.along));
            ring.sides = std::min(ring.sides, rings.back().sides);
        }
        ring.y = glm::cross(ring.along, ring.x);
        rings.push_back(ring);
    }
    return rings;
}

/// The line without its points between two distances from its start.
void remove_between(std::vector<Point>& line, float low, float high) {
    float length = 0;
    std::vector<Point> kept{line.front()};
    for (std::size_t i = 1; i < line.size(); ++i) {
        length += glm::distance(line[i].position, line[i - 1].position);
        if (length <= low || length >= high || i + 1 == line.size())
            kept.push_back(line[i]);
    }
    line = std::move(kept);
}

float length_of(const std::vector<Point>& line) {
    float length = 0;
    for (std::size_t i = 1; i < line.size(); ++i)
        length += glm::distance(line[i].position, line[i - 1].position);
    return length;
}

/// A collar's rings are so much wider than the branch: its foot inside the parent, where it comes out, and beyond.
constexpr std::array<float, 3> collar_widening = {0.6f, 1.65f, 1.22f};

/// Takes points away where the line bends so sharply, or its points lie so close, that their rings would cross: a ring
/// stands in the middle plane of its bend, and reaches radius x tan(half the bend) along the line on the inner side.
void remove_crossings(std::vector<Point>& line, std::size_t first) {
    const auto reach = [&](std::size_t i) {
        if (i == 0 || i + 1 >= line.size())
            return 0.f;
        const glm::vec3 before = unit_or(line[i].position - line[i - 1].position, {0, 1, 0}),
                        after = unit_or(line[i + 1].position - line[i].position, {0, 1, 0});
        if (glm::dot(before, after) < -0.17f) // more than 100 degrees: a hairpin
            return 1e30f;
        return line[i].radius * glm::length(before - after) / glm::length(before + after);
    };
    for (std::size_t i = first; i < line.size() && line.size() > 3;) {
        const float before = reach(i - 1), here = reach(i);
        const std::size_t sharper = i + 1 == line.size() || (before > here && i > first) ? i - 1 : i;
        if (1.2f * (before + here) <= glm::distance(line[i].position, line[i - 1].position) || sharper < first) {
            ++i;
            continue;
        }
        line.erase(line.begin() + std::ptrdiff_t(sharper));
        i = std::max(first, i - 1);
    }
}

/// Replaces the start of a line by the rings of a collar. Returns false if the branch is too short to have one.
bool add_collar(std::vector<Point>& line, const Joint& joint) {
    const glm::vec3 out = unit_or(line[1].position - line[0].position, {0, 1, 0});
    const float sine = std::max(glm::length(glm::cross(out, joint.axis)), 0.4f), radius = line[0].radius;
    const float surface = joint.radius_m / sine; // where the centre line leaves the parent
    // In the crotch the ring that lies on the parent reaches so much farther along the branch.
    const float crotch = collar_widening[1] * radius * std::sqrt(1 - std::min(1.f, sine * sine)) / sine;
    const float second = surface + std::max(0.9f * radius, crotch + 0.4f * radius), third = second + 1.3f * radius;
    if (length_of(line) < third + 0.8f * radius)
        return false;
    remove_between(line, 0, third - 0.3f * radius);
    insert_at(line, third);
    insert_at(line, second);
    insert_at(line, surface);
    return line.size() > 4;
}

std::vector<Ring> place_rings(const Branch& branch, const Joint& joint, const GrowthParameters& p) {
    std::vector<Point> line = centre_line(branch.nodes);
    // Coincident points have no direction.
    line.erase(
        std::unique(line.begin(), line.end(),
                    [](const Point& a, const Point& b) { return glm::distance(a.position, b.position) < 1e-6f; }),
        line.end());
    if (line.size() < 2)
        line.push_back({line[0].position + glm::vec3(0, std::max(1e-4f, line[0].radius), 0), line[0].radius});
    const float radius = line[0].radius;
    const bool is_trunk = joint.radius_m <= 0;
    if (!is_trunk && glm::distance(joint.centre, line[1].position) > 1e-6f)
        line[0].position = joint.centre;
    if (is_trunk && p.root_flare > 0)
        for (const float share : {0.35f, 0.9f, 1.8f, 3.2f})
            insert_at(line, share * radius);
    const bool has_collar = !is_trunk && radius > 0.006f && add_collar(line, joint);
    remove_crossings(line, has_collar ? 4 : 1);
    std::vector<Ring> rings = rings_along(line, is_trunk);
    if (has_collar) {
        for (std::size_t i = 0; i < 3; ++i)
            rings[i].radius_m *= std::min(collar_widening[i], std::max(1.f, 0.9f * joint.radius_m / rings[i].radius_m));
        rings[0].radius_m = std::min(rings[0].radius_m, 0.6f * joint.radius_m);
        rings[1].on_parent = true;
    }
    rings.back().radius_m = 0;
    return rings;
}

/// The place on the parent's centre line nearest to where a branch begins.
Joint joint_on(const std::vector<Ring>& parent, const glm::vec3& start) {
    Joint joint;
    float nearest = 1e30f;
    for (std::size_t i = 0; i + 1 < parent.size(); ++i) {
        const glm::vec3 way = parent[i + 1].centre - parent[i].centre;
        const float t =
            std::clamp(glm::dot(start - parent[i].centre, way) / std::max(glm::dot(way, way), 1e-20f), 0.f, 1.f);
        const glm::vec3 here = parent[i].centre + t * way;
        if (const float d = glm::distance(here, start); d < nearest) {
            nearest = d;
            joint = {here, unit_or(way, parent[i].along),
                     std::max(1e-6f, glm::mix(parent[i].radius_m, parent[i + 1].radius_m, t))};
        }
    }
    return joint;
}

/// Where the line left out a knot, several of its nodes have the same nearest place, or change their order: one of
/// them is enough. Nodes at which branches begin stay.
void remove_knots(std::vector<Branch::Node>& nodes, const std::vector<glm::vec3>& forks) {
    const auto is_fork = [&](std::size_t n) {
        return std::find(forks.begin(), forks.end(), nodes[n].position) != forks.end();
    };
    const auto erase = [&](std::size_t n) { nodes.erase(nodes.begin() + std::ptrdiff_t(n)); };
    for (std::size_t n = 1; n < nodes.size() && nodes.size() > 2;) {
        const glm::vec3 before = nodes[n].position - nodes[n - 1].position;
        if (glm::length(before) < 1e-6f) {
            const bool keep_this = n > 1 && (n + 1 == nodes.size() || is_fork(n));
            erase(keep_this ? n - 1 : n);
            n = std::max<std::size_t>(1, n - 1);
            continue;
        }
        const glm::vec3 after = n + 1 < nodes.size() ? nodes[n + 1].position - nodes[n].position : before;
        if (glm::dot(before, after) >= -0.17f * glm::length(before) * glm::length(after)) {
            ++n;
        } else if (!is_fork(n)) {
            erase(n);
            n = std::max<std::size_t>(1, n - 1);
        } else if (n > 1 && !is_fork(n - 1)) {
            erase(n - 1);
            --n;
        } else if (n + 2 < nodes.size() && !is_fork(n + 1)) {
            erase(n + 1);
        } else {
            ++n;
        }
    }
}

} // namespace

std::vector<Tube> make_tubes(const Skeleton& skeleton, const GrowthParameters& parameters) {
    std::vector<Tube> tubes(skeleton.branches.size());
    for (std::size_t i = 0; i < tubes.size(); ++i) {
        const Branch& branch = skeleton.branches[i];
        if (branch.parent >= 0)
            tubes[i].joint = joint_on(tubes[std::size_t(branch.parent)].rings, branch.nodes[0].position);
        tubes[i].rings = place_rings(branch, tubes[i].joint, parameters);
    }
    return tubes;
}

void move_to_centre_lines(Skeleton& skeleton, const std::vector<Tube>& tubes) {
    for (std::size_t i = 0; i < skeleton.branches.size(); ++i) {
        Branch& branch = skeleton.branches[i];
        for (std::size_t n = branch.parent >= 0 ? 1 : 0; n < branch.nodes.size(); ++n)
            branch.nodes[n].position = joint_on(tubes[i].rings, branch.nodes[n].position).centre;
        if (branch.parent >= 0)
            branch.nodes[0].position = tubes[i].joint.centre;
    }
    std::vector<std::vector<glm::vec3>> forks(skeleton.branches.size());
    for (std::size_t i = 0; i < tubes.size(); ++i)
        if (skeleton.branches[i].parent >= 0)
            forks[std::size_t(skeleton.branches[i].parent)].push_back(tubes[i].joint.centre);
    for (std::size_t i = 0; i < tubes.size(); ++i)
        remove_knots(skeleton.branches[i].nodes, forks[i]);
}

} // namespace kokage
