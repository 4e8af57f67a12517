#include "trees/growth/leaf_shape.h"

#include "trees/growth/directions.h"
#include "trees/growth/leaf_image.h"
#include "trees/growth/triangulate_polygon.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

constexpr float petiole_width_m = 0.0015f;

/// Collects a leaf's mesh.
class ShapeBuilder {
  public:
    explicit ShapeBuilder(const GrowthParameters& p)
        : p_(p), width_(float(p.leaf_width)), petiole_(float(p.petiole_length)) {}

    LeafShape shape;

    /// A blade from its outline.
    void add_blade() {
        const HalfOutline& right = half_outline(p_.leaf_shape, p_.leaf_detail);
        const std::size_t edge = right.size();
        std::vector<glm::vec2> corners(right.begin(), right.end());
        const int on_midrib = p_.leaf_detail >= 2 ? 3 : p_.leaf_detail == 1 && p_.leaf_shape != LeafKind::oak ? 1 : 0;
        for (int i = on_midrib; i >= 1; --i)
            corners.push_back({0, glm::mix(right[0].y, 1.f, float(i) / float(on_midrib + 1))});
        const std::vector<glm::uvec3> half = triangulate_polygon(corners);
        for (const glm::vec2& q : corners)
            add_blade_vertex(q, right[0].y);
        // The left side: the edge's vertices mirrored, the midrib's shared.
        std::vector<std::uint32_t> mirrored(corners.size());
        for (std::size_t i = 0; i < corners.size(); ++i) {
            mirrored[i] = std::uint32_t(i);
            if (i > 0 && i + 1 < edge) {
                mirrored[i] = std::uint32_t(shape.positions.size());
                add_blade_vertex({-corners[i].x, corners[i].y}, right[0].y);
            }
        }
        shape.triangles = half;
        for (const glm::uvec3& t : half)
            shape.triangles.push_back({mirrored[t.x], mirrored[t.z], mirrored[t.y]});
        add_petiole();
    }

    /// A flat card that holds the blade's whole unit square; `turn` about the midrib.
    void add_card(float turn) {
        const std::uint32_t first = std::uint32_t(shape.positions.size());
        const float c = std::cos(turn), s = std::sin(turn);
        const float low = petiole_ - foot_of_blade();
        for (const glm::vec2& q : {glm::vec2(-0.5f, 0), glm::vec2(0.5f, 0), glm::vec2(0.5f, 1), glm::vec2(-0.5f, 1)})
            add_vertex({c * q.x * width_, low + q.y, -s * q.x * width_}, {s, 0, c}, {q.x + 0.5f, 1 - q.y});
        shape.triangles.push_back({first, first + 1, first + 2});
        shape.triangles.push_back({first, first + 2, first + 3});
    }

    /// Needles as triangles (detail 0), strips (1) or strips with a point (2); petals as kites or hexagons.
    void add_spray(const Spray& spray) {
        for (std::size_t i = 0; i < spray.segments.size(); ++i)
            add_segment(spray.segments[i], i >= spray.first_half);
    }

    void add_petiole() {
        if (petiole_ <= 0.1f)
            return;
        const float half = 0.5f * petiole_width_m / float(p_.leaf_length);
        // An aspen's petiole is flattened across the blade, which is why its leaves tremble.
        const bool upright = p_.leaf_shape == LeafKind::aspen;
        const glm::vec3 across = upright ? glm::vec3(0, 0, -half) : glm::vec3(half, 0, 0),
                        normal = upright ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
        const std::uint32_t first = std::uint32_t(shape.positions.size());
        const glm::vec2 uv{0.5f, 1 - std::max(0.12f, foot_of_blade() + 0.04f)}; // the midrib's colour
        const glm::vec3 top{0, petiole_, 0};
        for (const glm::vec3& position : {-across, across, top + across, top - across})
            add_vertex(position, normal, uv);
        shape.triangles.push_back({first, first + 1, first + 2});
        shape.triangles.push_back({first, first + 2, first + 3});
    }

    double triangle_area() const {
        double area = 0;
        for (const glm::uvec3& t : shape.triangles) {
            const glm::dvec3 a(shape.positions[t.x]), b(shape.positions[t.y]), c(shape.positions[t.z]);
            area += 0.5 * glm::length(glm::cross(b - a, c - a));
        }
        return area;
    }

  private:
    /// Where the petiole meets the blade, along the blade.
    float foot_of_blade() const {
        return has_needles(p_.leaf_shape) || is_in_blossom(p_) ? 0.f : half_outline(p_.leaf_shape, 1)[0].y;
    }

    void add_vertex(const glm::vec3& position, const glm::vec3& normal, const glm::vec2& uv) {
        shape.positions.push_back(position);
        shape.normals.push_back(normal);
        shape.uvs.push_back(uv);
    }

    /// Along the midrib the blade is an arc of a circle; both halves are folded up from it.
    void add_blade_vertex(const glm::vec2& q, float foot) {
        const float bend = radians(p_.leaf_bend), fold = radians(p_.leaf_fold), y = q.y - foot, angle = bend * y;
        const glm::vec3 on_midrib =
            bend > 1e-4f ? glm::vec3(0, std::sin(angle), std::cos(angle) - 1) / bend + glm::vec3(0, petiole_, 0)
                         : glm::vec3(0, petiole_ + y, 0);
        const glm::vec3 up{0, std::sin(angle), std::cos(angle)}, across{1, 0, 0};
        const float side = q.x > 0 ? 1.f : q.x < 0 ? -1.f : 0.f, x = q.x * width_;
        add_vertex(on_midrib + x * std::cos(fold) * across + std::abs(x) * std::sin(fold) * up,
                   side == 0 ? up : std::cos(fold) * up - side * std::sin(fold) * across, {q.x + 0.5f, 1 - q.y});
    }

    void add_segment(const SpraySegment& segment, bool second_half) {
        const glm::vec3 along = segment.tip - segment.base,
                        normal = unit_or(glm::cross(segment.across, along), {0, 0, 1});
        const std::uint32_t first = std::uint32_t(shape.positions.size());
        const auto add = [&](float t, float half_width) {
            const glm::vec3 position = segment.base + t * along + half_width * segment.across;
            // The second half is the first one turned: there -z is what x is in the first.
            const float x = second_half ? -position.z : position.x;
            add_vertex(position + glm::vec3(0, petiole_, 0), normal,
                       {std::clamp(x / width_ + 0.5f, 0.f, 1.f), std::clamp(1 - position.y, 0.f, 1.f)});
        };
        const auto face = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            shape.triangles.push_back({first + a, first + b, first + c});
        };
        const float w = segment.half_width;
        if (segment.is_petal) {
            add(0, 0);
            add(0.62f, w);
            if (p_.leaf_detail >= 1) { // a petal's end is notched
                add(0.95f, 0.55f * w);
                add(0.88f, 0);
                add(0.95f, -0.55f * w);
                add(0.62f, -w);
                face(0, 1, 3);
                face(1, 2, 3);
                face(0, 3, 5);
                face(3, 4, 5);
            } else {
                add(1, 0);
                add(0.62f, -w);
                face(0, 1, 2);
                face(0, 2, 3);
            }
        } else if (p_.leaf_detail <= 0) { // the area of a needle as wide as this on average
            add(0, -1.8f * w);
            add(0, 1.8f * w);
            add(1, 0);
            face(0, 1, 2);
        } else {
            const float shoulder = p_.leaf_detail >= 2 ? 0.85f : 1.f;
            add(0, -w);
            add(0, w);
            add(shoulder, p_.leaf_detail >= 2 ? w : 0.8f * w);
            add(shoulder, p_.leaf_detail >= 2 ? -w : -0.8f * w);
            face(0, 1, 2);
            face(0, 2, 3);
            if (p_.leaf_detail >= 2) {
                add(1, 0);
                face(3, 2, 4);
            }
        }
    }

    const GrowthParameters& p_;
    float width_, petiole_;
};

} // namespace

bool is_in_blossom(const GrowthParameters& p) {
    return p.season == Season::blossom && p.leaf_shape == LeafKind::cherry;
}

bool is_bare(const GrowthParameters& p) {
    return p.season == Season::winter && !has_needles(p.leaf_shape);
}

std::optional<Spray> leaf_spray(const GrowthParameters& p) {
    const float width = float(p.leaf_width);
    if (is_in_blossom(p))
        return cherry_blossom(width);
    switch (p.leaf_shape) {
    case LeafKind::pine:
        return pine_spray(p.needles, width);
    case LeafKind::spruce:
        return spruce_spray(p.needles, width);
    case LeafKind::cypress:
        return cypress_spray(p.needles, width);
    default:
        return std::nullopt;
    }
}

LeafShape leaf_shape(const GrowthParameters& p) {
    ShapeBuilder builder(p);
    const std::optional<Spray> spray = leaf_spray(p);
    if (p.leaf_form == LeafForm::alpha) {
        builder.add_card(0);
        builder.shape.area = builder.triangle_area() * solid_share(*leaf_mask(p), mask_cutoff);
        const double cards = builder.triangle_area();
        if (!spray)
            builder.add_petiole();
        builder.shape.area += builder.triangle_area() - cards;
        return std::move(builder.shape);
    }
    if (spray)
        builder.add_spray(*spray);
    else
        builder.add_blade();
    builder.shape.area = builder.triangle_area();
    return std::move(builder.shape);
}

double mean_leaf_area(const GrowthParameters& p) {
    // The mean of length^2 over lengths spread evenly by +- s of their mean.
    const double spread = p.leaf_length_spread;
    GrowthParameters in_leaf = p;
    in_leaf.season = Season::summer;
    return p.leaf_length * p.leaf_length * (1 + spread * spread / 3) * leaf_shape(in_leaf).area;
}

} // namespace kokage
