#include "trees/growth/bark.h"

#include "common/services/parallel.h"
#include "common/services/random.h"
#include "trees/growth/directions.h"
#include "trees/growth/streams.h"
#include "trees/growth/tube.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kokage {
namespace {

struct MeshTraits : OpenMesh::DefaultTraits {
    VertexAttributes(OpenMesh::Attributes::Normal | OpenMesh::Attributes::Status);
    FaceAttributes(OpenMesh::Attributes::Normal | OpenMesh::Attributes::Status);
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<MeshTraits>;

OpenMesh::Vec3f to_openmesh(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}
glm::vec3 from_openmesh(const OpenMesh::Vec3f& v) {
    return {v[0], v[1], v[2]};
}

/// A triangle of a tube: mesh vertices and where around the ring each corner is taken to lie (1 and 0 are the same
/// vertex: the seam).
struct TubeFace {
    std::array<Mesh::VertexHandle, 3> corners;
    std::array<float, 3> around, along; ///< texture coordinates
    std::uint32_t segment;              ///< between ring `segment` and the next
    bool is_foot;                       ///< closes the lower end
    float middle_around;
};

/// Pieces of bark with own vertices and patch numbers from 0, to be put one after the other.
struct BarkPiece {
    TreePart part;
    std::uint32_t patches = 0;
    std::vector<BarkPlace> places;
};

class TubeBuilder {
  public:
    TubeBuilder(const Tube& tube, std::uint64_t index, const GrowthParameters& p)
        : rings_(tube.rings), joint_(tube.joint), is_trunk_(tube.joint.radius_m <= 0), index_(std::uint32_t(index)),
          flare_(float(p.root_flare)), tile_(float(p.bark_tile)), random_(p.seed, streams::of(streams::bark, index)) {
        phase_ = random_.uniform(0.f, 2 * kPi);
        add_vertices();
        place_texture();
        add_foot();
        for (std::uint32_t i = 0; i + 1 < rings_.size(); ++i)
            bridge(i);
        check();
        mesh_.update_face_normals();
        mesh_.update_vertex_normals();
        blend_normals_into_parent();
    }

    void append_to(BarkPiece& piece) {
        sort_into_patches(piece);
        std::vector<std::int32_t> at(mesh_.n_vertices() * 2,
                                     -1); // a seam vertex is written twice, with u = 0 and u = full
        for (const TubeFace& face : faces_) {
            glm::uvec3 t{0};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t slot =
                    std::size_t(face.corners[k].idx()) * 2 + (face.around[k] >= float(tiles_) ? 1 : 0);
                if (at[slot] < 0) {
                    at[slot] = std::int32_t(piece.part.positions.size());
                    piece.part.positions.push_back(from_openmesh(mesh_.point(face.corners[k])));
                    piece.part.normals.push_back(unit_or(from_openmesh(mesh_.normal(face.corners[k])), {0, 1, 0}));
                    piece.part.uvs.push_back({face.around[k], face.along[k]});
                }
                t[k] = std::uint32_t(at[slot]);
            }
            piece.part.triangles.push_back(t);
        }
    }

  private:
    /// Roots and unevenness: the share by which the radius grows.
    float swelling(const Ring& ring, float angle) {
        float swell = 1;
        if (is_trunk_) {
            const float base = rings_[0].radius_m, height = ring.from_start_m;
            const float buttress =
                0.5f + 0.5f * std::cos(5 * angle + phase_) * (0.7f + 0.3f * std::cos(2 * angle + 2 * phase_));
            swell += flare_ * std::exp(-height / (0.9f * base)) * (0.45f + 0.75f * buttress);
            swell += 0.07f * std::cos(5 * angle + phase_) * std::exp(-height / (6 * base));
        }
        return ring.radius_m > 0.02f ? swell * (1 + 0.045f * random_.uniform(-1.f, 1.f)) : swell;
    }

    void add_vertices() {
        for (const Ring& ring : rings_) {
            vertices_.emplace_back();
            if (&ring == &rings_.back()) { // the tip is one vertex
                vertices_.back().push_back(mesh_.add_vertex(to_openmesh(ring.centre)));
                return;
            }
            for (int k = 0; k < ring.sides; ++k) {
                const float angle = 2 * kPi * float(k) / float(ring.sides);
                const float radius = ring.radius_m * (ring.on_parent ? 1.f : swelling(ring, angle));
                glm::vec3 position = ring.centre + radius * (std::cos(angle) * ring.x + std::sin(angle) * ring.y);
                if (ring.on_parent)
                    position = slid_on_to_parent(position, ring.along);
                vertices_.back().push_back(mesh_.add_vertex(to_openmesh(position)));
            }
        }
    }

    /// The place on the parent's cylinder (a little inside it, because its sides are flat) that lies before or behind a
    /// point in the branch's direction; where the branch passes it by, the nearest place to it.
    glm::vec3 slid_on_to_parent(const glm::vec3& point, const glm::vec3& along) const {
        const auto across = [&](const glm::vec3& v) { return v - glm::dot(v, joint_.axis) * joint_.axis; };
        const glm::vec3 q = across(point - joint_.centre), d = across(along);
        const float radius = 0.93f * joint_.radius_m, a = std::max(glm::dot(d, d), 0.04f), b = glm::dot(q, d),
                    c = glm::dot(q, q) - radius * radius;
        const float t = (-b + std::sqrt(std::max(0.f, b * b - a * c))) / a;
        // Never past the rings before and behind.
        return point + std::clamp(t, -0.8f * glm::dot(rings_[1].centre - rings_[0].centre, along),
                                  0.8f * glm::dot(rings_[2].centre - rings_[1].centre, along)) *
                           along;
    }

    /// Where a branch comes out of its parent, both are lit alike: no crease shows.
    void blend_normals_into_parent() {
        if (rings_.size() < 2 || !rings_[1].on_parent)
            return;
        for (const Mesh::VertexHandle v : vertices_[1]) {
            const glm::vec3 from_axis = from_openmesh(mesh_.point(v)) - joint_.centre;
            const glm::vec3 outwards = unit_or(from_axis - glm::dot(from_axis, joint_.axis) * joint_.axis, {0, 1, 0});
            const glm::vec3 own = unit_or(from_openmesh(mesh_.point(v)) - rings_[1].centre, outwards);
            mesh_.set_normal(v, to_openmesh(unit_or(outwards + 0.35f * own, outwards)));
        }
    }

    /// v of every ring: steps of length over the local size of a tile, so that texels stay square as the branch tapers.
    void place_texture() {
        const auto around = [](const Ring& ring) { return 2 * kPi * std::max(ring.radius_m, 1e-4f); };
        tiles_ = std::max(1, int(std::lround(around(rings_[0]) / tile_)));
        along_.assign(1, random_.uniform());
        for (std::size_t i = 1; i < rings_.size(); ++i) {
            const float middle =
                i + 1 < rings_.size() ? std::sqrt(around(rings_[i]) * around(rings_[i - 1])) : around(rings_[i - 1]);
            along_.push_back(along_.back() +
                             (rings_[i].from_start_m - rings_[i - 1].from_start_m) * float(tiles_) / middle);
        }
    }

    void add_face(std::array<Mesh::VertexHandle, 3> corners, std::array<float, 3> around, std::array<float, 3> along,
                  std::uint32_t segment, bool is_foot = false) {
        if (!mesh_.add_face(corners[0], corners[1], corners[2]).is_valid())
            throw std::logic_error("bark: a branch's faces do not form a manifold");
        for (float& a : around)
            a *= float(tiles_);
        faces_.push_back(
            {corners, around, along, segment, is_foot, (around[0] + around[1] + around[2]) / (3 * float(tiles_))});
    }

    /// Closes the lower end (inside the parent, or on the ground) with a fan that looks back along the branch.
    void add_foot() {
        const auto& ring = vertices_[0];
        for (std::size_t k = 1; k + 1 < ring.size(); ++k) {
            const float n = float(ring.size());
            add_face({ring[0], ring[k + 1], ring[k]}, {0, float(k + 1) / n, float(k) / n},
                     {along_[0], along_[0], along_[0]}, 0, true);
        }
    }

    /// Joins ring i to ring i + 1, which may have fewer vertices: always takes the step that comes first around.
    void bridge(std::uint32_t i) {
        const auto &lower = vertices_[i], &upper = vertices_[i + 1];
        const std::size_t n = lower.size(), m = upper.size() == 1 ? 0 : upper.size();
        const auto place = [](std::size_t k, std::size_t count) { return count == 0 ? 0.5f : float(k) / float(count); };
        std::size_t a = 0, b = 0;
        while (a < n || b < m) {
            const bool step_below = b >= m || (a < n && float(a + 1) / float(n) <= float(b + 1) / float(m) + 1e-6f);
            // A ring has at least one vertex. NOLINTNEXTLINE(clang-analyzer-core.DivideZero)
            const Mesh::VertexHandle low = lower[a % n], up = m == 0 ? upper[0] : upper[b % m];
            if (step_below) {
                // At a tip every face gets the middle of its own side as the tip's place around.
                const float tip = m == 0 ? (float(a) + 0.5f) / float(n) : place(b, m);
                add_face({low, lower[(a + 1) % n], up}, {place(a, n), place(a + 1, n), tip},
                         {along_[i], along_[i], along_[i + 1]}, i);
                ++a;
            } else {
                add_face({low, upper[(b + 1) % m], up}, {place(a, n), place(b + 1, m), place(b, m)},
                         {along_[i], along_[i + 1], along_[i + 1]}, i);
                ++b;
            }
        }
    }

    void check() const {
        for (const auto edge : mesh_.edges())
            if (mesh_.is_boundary(edge))
                throw std::logic_error("bark: a branch is not closed");
    }

    /// Cuts the tube into patches about as long as they are wide: sectors around thick wood, whole rounds of thin wood.
    /// What no light reaches (the foot of thick wood, and all up to the parent's surface) is a patch of its own, so
    /// that it does not darken the mean of what can be seen.
    void sort_into_patches(BarkPiece& piece) {
        const int sides = rings_[0].sides;
        const int sectors = sides <= 4 ? 1 : sides <= 7 ? 3 : sides / 2;
        std::vector<std::uint32_t> group(rings_.size(), 0);
        std::uint32_t current = 0;
        float begin = 0;
        for (std::size_t i = 1; i + 1 < rings_.size(); ++i) {
            const float wide = std::max(2 * kPi * rings_[i].radius_m / float(sectors), 0.05f);
            if (rings_[i].from_start_m - begin >= wide) {
                ++current;
                begin = rings_[i].from_start_m;
            }
            group[i] = current;
        }
        const std::uint32_t first_lit_segment = rings_[1].on_parent ? 1 : 0;
        const auto key = [&](const TubeFace& face) {
            if (sides > 4 && (face.is_foot || face.segment < first_lit_segment))
                return 0u;
            return 1 + group[face.segment] * std::uint32_t(sectors) +
                   std::min(std::uint32_t(face.middle_around * float(sectors)), std::uint32_t(sectors - 1));
        };
        std::stable_sort(faces_.begin(), faces_.end(),
                         [&](const TubeFace& a, const TubeFace& b) { return key(a) < key(b); });
        for (std::size_t i = 0; i < faces_.size(); ++i) {
            if (i == 0 || key(faces_[i]) != key(faces_[i - 1])) {
                ++piece.patches;
                const Ring& ring = rings_[faces_[i].segment];
                piece.places.push_back({ring.radius_m, ring.centre.y, is_trunk_, index_});
            }
            piece.part.triangle_patch.push_back(piece.patches - 1);
        }
    }

    const std::vector<Ring>& rings_;
    const Joint& joint_;
    bool is_trunk_;
    std::uint32_t index_;
    float flare_, tile_, phase_ = 0;
    int tiles_ = 1;
    Random random_;
    Mesh mesh_;
    std::vector<std::vector<Mesh::VertexHandle>> vertices_;
    std::vector<float> along_;
    std::vector<TubeFace> faces_;
};

} // namespace

std::uint32_t make_bark(const std::vector<Tube>& tubes, const GrowthParameters& parameters, TreePart& part,
                        std::vector<BarkPlace>* places) {
    constexpr std::size_t block = 64;
    const std::size_t count = tubes.size();
    std::vector<BarkPiece> pieces((count + block - 1) / block);
    parallel_blocks(count, block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            TubeBuilder(tubes[i], i, parameters).append_to(pieces[begin / block]);
        }
    });
    part.kind = TreePartKind::bark;
    std::uint32_t patches = 0;
    for (const BarkPiece& piece : pieces) {
        const std::uint32_t first = std::uint32_t(part.positions.size());
        part.positions.insert(part.positions.end(), piece.part.positions.begin(), piece.part.positions.end());
        part.normals.insert(part.normals.end(), piece.part.normals.begin(), piece.part.normals.end());
        part.uvs.insert(part.uvs.end(), piece.part.uvs.begin(), piece.part.uvs.end());
        for (const glm::uvec3& t : piece.part.triangles)
            part.triangles.push_back(t + glm::uvec3(first));
        for (const std::uint32_t patch : piece.part.triangle_patch)
            part.triangle_patch.push_back(patches + patch);
        patches += piece.patches;
        if (places)
            places->insert(places->end(), piece.places.begin(), piece.places.end());
    }
    return patches;
}

} // namespace kokage
