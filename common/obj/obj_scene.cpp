#include "common/obj/obj_scene.h"

#include "common/geometry/polygon.h"
#include "common/obj/obj_colors.h"
#include "common/obj/obj_materials.h"
#include "common/services/error.h"
#include "common/services/named_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <istream>
#include <limits>
#include <streambuf>
#include <tiny_obj_loader.h>
#include <unordered_map>

namespace kokage {
namespace {

constexpr std::uint64_t kMaximumObjFile = 0xffffffffu;
constexpr std::size_t kMaximumLine = std::size_t(1) << 16;
constexpr int kMaximumCorners = 1024;
constexpr double kLargestCoordinate = 1e30;
constexpr std::size_t kMaximumMeshes = std::size_t(1) << 16;

/// A stream over bytes that lie elsewhere.
struct ByteStream : std::streambuf {
    explicit ByteStream(std::vector<unsigned char>& bytes) {
        char* begin = reinterpret_cast<char*>(bytes.data());
        setg(begin, begin, begin + bytes.size());
    }
};

/// What a corner of a face names: position, texture coordinate, normal (-1 = none).
using Corner = std::array<int, 3>;

struct CornerHash {
    std::size_t operator()(const Corner& c) const {
        std::uint64_t hash = 0;
        for (const int part : c)
            hash = (hash ^ std::uint64_t(std::uint32_t(part))) * 0x9e3779b97f4a7c15u;
        return std::size_t(hash ^ hash >> 32);
    }
};

/// A mesh in the making.
struct MeshBuilder {
    std::string name;
    int material = 0;
    std::vector<Corner> vertices;
    std::unordered_map<Corner, std::uint32_t, CornerHash> index;
    std::vector<glm::uvec3> triangles;
};

class ObjReader {
  public:
    ObjReader(const std::filesystem::path& path, Progress& progress)
        : path_(path), progress_(progress), materials_(path, scene_.notes) {}

    MeshScene read() {
        std::vector<unsigned char> bytes = read_file_bytes(path_, kMaximumObjFile);
        read_lines(bytes);
        if (!colors_.empty())
            materials_.take_colors_of_vertices();
        progress_.throw_if_stopped();
        ByteStream buffer(bytes);
        std::istream stream(&buffer);
        tinyobj::callback_t callbacks;
        callbacks.vertex_cb = [](void* self, float x, float y, float z, float) { to(self).add_position({x, y, z}); };
        callbacks.texcoord_cb = [](void* self, float x, float y, float) { to(self).add_uv({x, y}); };
        callbacks.normal_cb = [](void* self, float x, float y, float z) { to(self).normals_.emplace_back(x, y, z); };
        callbacks.index_cb = [](void* self, tinyobj::index_t* indices, int count) {
            to(self).add_face(indices, count);
        };
        callbacks.usemtl_cb = [](void* self, const char* name, int) { to(self).use_material(name); };
        callbacks.group_cb = [](void* self, const char** names, int count) {
            to(self).group_ = count > 0 ? names[0] : "";
            to(self).mesh_ = nullptr;
        };
        callbacks.object_cb = [](void* self, const char* name) {
            to(self).object_ = name;
            to(self).mesh_ = nullptr;
        };
        std::string warning, error;
        tinyobj::LoadObjWithCallback(stream, callbacks, this, nullptr, &warning, &error);
        if (meshes_.empty())
            fail("holds no faces");
        return finish();
    }

  private:
    static ObjReader& to(void* self) { return *static_cast<ObjReader*>(self); }
    [[noreturn]] void fail(const std::string& what) const { throw InputError(path_.string() + ": " + what); }

    /// Joins lines that end in '\', reads material libraries and vertices' colours, and refuses what is no text or has
    /// lines without end.
    void read_lines(std::vector<unsigned char>& bytes) {
        if (is_written_by_blender({reinterpret_cast<const char*>(bytes.data()), bytes.size()}))
            materials_.take_kd_as_linear();
        std::size_t begin = 0, number = 1;
        for (std::size_t i = 0; i <= bytes.size(); ++i) {
            if (i < bytes.size() && bytes[i] == 0)
                fail("is not an OBJ file: line " + std::to_string(number) + " holds a zero byte");
            if (i < bytes.size() && bytes[i] != '\n') {
                if (i - begin >= kMaximumLine)
                    fail("line " + std::to_string(number) + " is longer than the limit of " +
                         std::to_string(kMaximumLine) + " bytes");
                continue;
            }
            ++number;
            const std::size_t end = i > begin && bytes[i - 1] == '\r' ? i - 1 : i;
            if (i < bytes.size() && end > begin && bytes[end - 1] == '\\') {
                std::memset(bytes.data() + end - 1, ' ', i - end + 2);
                continue;
            }
            if (end - begin > 7 && std::memcmp(bytes.data() + begin, "mtllib", 6) == 0)
                materials_.read_library(
                    std::string(bytes.begin() + std::ptrdiff_t(begin) + 7, bytes.begin() + std::ptrdiff_t(end)));
            check_vertex({reinterpret_cast<const char*>(bytes.data()) + begin, end - begin}, number - 1);
            colors_.read_line({reinterpret_cast<const char*>(bytes.data()) + begin, end - begin});
            begin = i + 1;
        }
    }

    /// The parser takes 0 for what is no number.
    void check_vertex(std::string_view line, std::size_t number) const {
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        if (line.size() < 2 || line[0] != 'v' || (line[1] != ' ' && line[1] != '\t'))
            return;
        line.remove_prefix(1);
        for (int k = 0; k < 3; ++k) {
            line.remove_prefix(std::min(line.find_first_not_of(" \t+"), line.size()));
            double value = 0;
            const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
            if (error != std::errc() || !(std::abs(value) <= kLargestCoordinate))
                fail("line " + std::to_string(number) +
                     ": a vertex needs three finite numbers; mend or export it anew");
            line.remove_prefix(std::size_t(end - line.data()));
        }
    }

    void add_position(const glm::vec3& position) {
        if (positions_.size() >= kMaximumSceneVertices)
            fail("more than the limit of " + std::to_string(kMaximumSceneVertices) + " vertices");
        positions_.push_back(position);
    }

    void add_uv(const glm::vec2& uv) {
        uvs_.push_back(std::isfinite(uv.x) && std::isfinite(uv.y) ? uv : glm::vec2(0.f));
    }

    void use_material(const std::string& name) {
        const std::size_t end = name.find_last_not_of(" \t");
        material_ = materials_.index_of(end == std::string::npos ? "" : name.substr(0, end + 1));
        mesh_ = nullptr;
    }

    /// OBJ counts from 1, and from the last one backwards where negative; 0 stands for none.
    int resolved(int index, std::size_t count, const char* what) const {
        if (index == 0)
            return -1;
        const std::int64_t place = index > 0 ? std::int64_t(index) - 1 : std::int64_t(count) + index;
        if (place < 0 || place >= std::int64_t(count))
            fail("face " + std::to_string(faces_) + " names " + what + " " + std::to_string(index) + " of " +
                 std::to_string(count));
        return int(place);
    }

    MeshBuilder& current_mesh() {
        if (mesh_)
            return *mesh_;
        if (material_ < 0)
            material_ = materials_.index_of("");
        const std::string name = !object_.empty() ? object_ : group_;
        const auto [found, is_new] = by_name_.try_emplace({name, material_}, meshes_.size());
        if (is_new) {
            if (meshes_.size() >= kMaximumMeshes)
                fail("more than the limit of " + std::to_string(kMaximumMeshes) + " groups");
            meshes_.emplace_back();
            meshes_.back().name = name;
            meshes_.back().material = material_;
        }
        mesh_ = &meshes_[found->second];
        return *mesh_;
    }

    void add_face(const tinyobj::index_t* indices, int count) {
        if (++faces_ % 65536 == 0)
            progress_.throw_if_stopped();
        if (count < 3)
            return;
        if (count > kMaximumCorners)
            fail("face " + std::to_string(faces_) + " has " + std::to_string(count) +
                 " corners, more than the limit of " + std::to_string(kMaximumCorners));
        std::vector<glm::dvec3> places;
        std::vector<std::uint32_t> vertices;
        MeshBuilder& mesh = current_mesh();
        for (int i = 0; i < count; ++i) {
            const Corner corner{resolved(indices[i].vertex_index, positions_.size(), "vertex"),
                                resolved(indices[i].texcoord_index, uvs_.size(), "texture coordinate"),
                                resolved(indices[i].normal_index, normals_.size(), "normal")};
            if (corner[0] < 0)
                fail("face " + std::to_string(faces_) + " has a corner without a vertex");
            const auto [found, is_new] = mesh.index.try_emplace(corner, std::uint32_t(mesh.vertices.size()));
            if (is_new)
                mesh.vertices.push_back(corner);
            vertices.push_back(found->second);
            places.emplace_back(positions_[std::size_t(corner[0])]);
        }
        for (const glm::uvec3& t : triangulate_polygon(places))
            mesh.triangles.emplace_back(vertices[t.x], vertices[t.y], vertices[t.z]);
        triangles_ += std::size_t(count) - 2;
        if (triangles_ > kMaximumSceneTriangles)
            fail("more than the limit of " + std::to_string(kMaximumSceneTriangles) + " triangles");
    }

    MeshScene finish() {
        glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-std::numeric_limits<double>::infinity());
        for (const MeshBuilder& builder : meshes_)
            for (const Corner& corner : builder.vertices) {
                low = glm::min(low, glm::dvec3(positions_[std::size_t(corner[0])]));
                high = glm::max(high, glm::dvec3(positions_[std::size_t(corner[0])]));
            }
        scene_.origin = choose_origin(low, high);
        scene_.materials = materials_.materials();
        scene_.materials.emplace_back().name = "default";
        scene_.materials.back().is_missing = true;
        for (MeshBuilder& builder : meshes_) {
            if (builder.triangles.empty())
                continue;
            progress_.throw_if_stopped();
            scene_.meshes.push_back(finished(builder));
        }
        if (scene_.meshes.empty())
            fail("holds no faces");
        return std::move(scene_);
    }

    SceneMesh finished(MeshBuilder& builder) const {
        SceneMesh mesh;
        mesh.name = mesh.mesh_name = builder.name;
        mesh.mesh_index = int(scene_.meshes.size());
        mesh.material = builder.material;
        mesh.triangles = std::move(builder.triangles);
        const ObjMaterials::TextureOptions& options = materials_.options(builder.material);
        bool any_uv = false, any_normal = false, all_normals = true;
        for (const Corner& corner : builder.vertices) {
            mesh.positions.push_back(glm::vec3(glm::dvec3(positions_[std::size_t(corner[0])]) - scene_.origin));
            if (!colors_.empty())
                mesh.colors.emplace_back(colors_.of_vertex(std::size_t(corner[0])), 1.f);
            any_uv = any_uv || corner[1] >= 0;
            any_normal = any_normal || corner[2] >= 0;
            all_normals = all_normals && corner[2] >= 0;
        }
        for (std::size_t i = 0; i < builder.vertices.size() && any_uv; ++i) {
            const int uv = builder.vertices[i][1];
            const glm::vec2 placed =
                options.offset + options.scale * (uv >= 0 ? uvs_[std::size_t(uv)] : glm::vec2(0.f));
            mesh.uvs.emplace_back(placed.x, 1.f - placed.y); // glTF's v points down
            if (!std::isfinite(mesh.uvs.back().x) || !std::isfinite(mesh.uvs.back().y))
                mesh.uvs.back() = glm::vec2(0.f);
        }
        mesh.normals = normals_of(builder, mesh, any_normal);
        return mesh;
    }

    /// Those of the file; computed from faces that share a position where it has none.
    std::vector<glm::vec3> normals_of(const MeshBuilder& builder, const SceneMesh& mesh, bool any_normal) const {
        std::vector<glm::vec3> normals(builder.vertices.size());
        std::vector<glm::vec3> computed;
        for (std::size_t i = 0; i < normals.size(); ++i) {
            const int stored = builder.vertices[i][2];
            const glm::dvec3 normal =
                any_normal && stored >= 0 ? glm::dvec3(normals_[std::size_t(stored)]) : glm::dvec3(0);
            const double length = glm::length(normal);
            if (length > 0 && std::isfinite(length)) {
                normals[i] = glm::vec3(normal / length);
                continue;
            }
            if (computed.empty())
                computed = smooth_normals(builder, mesh);
            normals[i] = computed[i];
        }
        return normals;
    }

    std::vector<glm::vec3> smooth_normals(const MeshBuilder& builder, const SceneMesh& mesh) const {
        std::unordered_map<int, std::uint32_t> welded;
        std::vector<glm::vec3> positions;
        std::vector<std::uint32_t> place;
        for (std::size_t i = 0; i < builder.vertices.size(); ++i) {
            const auto [found, is_new] = welded.try_emplace(builder.vertices[i][0], std::uint32_t(positions.size()));
            if (is_new)
                positions.push_back(mesh.positions[i]);
            place.push_back(found->second);
        }
        std::vector<glm::uvec3> triangles;
        for (const glm::uvec3& t : mesh.triangles)
            triangles.emplace_back(place[t.x], place[t.y], place[t.z]);
        const std::vector<glm::vec3> shared = compute_normals(positions, triangles);
        std::vector<glm::vec3> normals;
        for (const std::uint32_t p : place)
            normals.push_back(shared[p]);
        return normals;
    }

    const std::filesystem::path path_;
    Progress& progress_;
    MeshScene scene_;
    ObjMaterials materials_;
    ObjVertexColors colors_;
    std::vector<glm::vec3> positions_, normals_;
    std::vector<glm::vec2> uvs_;
    std::vector<MeshBuilder> meshes_;
    std::map<std::pair<std::string, int>, std::size_t> by_name_;
    MeshBuilder* mesh_ = nullptr; ///< that faces go to; null = to be found
    std::string object_, group_;
    int material_ = -1;
    std::size_t faces_ = 0, triangles_ = 0;
};

} // namespace

MeshScene read_obj_scene(const std::filesystem::path& path, Progress& progress) {
    return ObjReader(path, progress).read();
}

} // namespace kokage
