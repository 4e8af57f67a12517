#pragma once
// One small tree (small_tree_arrays.h) as a file of every kind that is read: each must give the same triangles.
// Compressed ones are made by the encoders of libdraco and libmeshoptimizer.
#include "common/scene/image_file.h"
#include "tests/support/gltf_text.h"
#include "tests/support/small_tree_arrays.h"
#include "tests/support/temporary_folder.h"

#include <OpenImageIO/imageio.h>
#include <cstdio>
#include <draco/compression/encode.h>
#include <functional>
#include <map>
#include <meshoptimizer.h>

namespace kokage {

/// A file with what lies beside it.
struct FileKind {
    std::string kind; ///< "draco", for messages
    std::string main; ///< the name of the tree's file
    std::map<std::string, std::string> files;
    float tolerance = 1e-6f; ///< of positions, normals and texture coordinates
};

inline void write_files(const FileKind& kind, const std::filesystem::path& folder) {
    for (const auto& [name, bytes] : kind.files) {
        std::filesystem::create_directories((folder / name).parent_path());
        std::ofstream(folder / name, std::ios::binary | std::ios::trunc) << bytes;
    }
}

/// A leaf in its card, 16 x 16 texels: green, solid in a diamond.
inline Image leaf_image() {
    Image image(16, 16, 4);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            float* pixel = image.at(x, y);
            pixel[0] = 0.1f;
            pixel[1] = 0.3f;
            pixel[2] = 0.05f;
            pixel[3] = std::abs(x - 7.5f) + std::abs(y - 7.5f) < 8 ? 1.f : 0.f;
        }
    return image;
}

inline std::vector<unsigned char> leaf_png() {
    const std::vector<std::byte> png = encode_png(leaf_image());
    const auto* bytes = reinterpret_cast<const unsigned char*>(png.data());
    return {bytes, bytes + png.size()};
}

inline std::vector<unsigned char> leaf_webp() {
    TemporaryFolder folder;
    const Image image = leaf_image();
    const std::string path = (folder / "leaf.webp").string();
    const auto output = OIIO::ImageOutput::create("webp");
    OIIO::ImageSpec spec(image.width, image.height, 4, OIIO::TypeDesc::UINT8);
    if (!output || !output->open(path, spec) || !output->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data()) ||
        !output->close())
        throw std::runtime_error("no WebP could be written");
    const std::string bytes = read_text(path);
    return {bytes.begin(), bytes.end()};
}

/// The glTF around two meshes, 0 trunk and 1 leaves: nodes, materials, a texture.
inline GltfText tree_around(bool with_image = true) {
    GltfText file;
    file.json["materials"] = {{{"name", "bark"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.3, 0.2, 0.1, 1.0}}}}},
                              {{"name", "leaf"},
                               {"alphaMode", "MASK"},
                               {"doubleSided", true},
                               {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    file.json["textures"] = {{{"source", 0}}};
    if (with_image) {
        file.json["images"] = {{{"mimeType", "image/png"}}};
        file.json["images"][0]["bufferView"] = file.view(leaf_png());
    }
    file.node({{"mesh", 0}, {"name", "trunk"}});
    file.node({{"mesh", 1}, {"name", "crown"}});
    file.scene({0, 1});
    return file;
}

inline nlohmann::json plain_primitive(GltfText& file, const PlainMesh& mesh, int material) {
    nlohmann::json attributes;
    attributes["POSITION"] = file.positions(mesh.positions);
    attributes["NORMAL"] = file.normals(mesh.normals);
    attributes["TEXCOORD_0"] = file.uvs(mesh.uvs);
    return {{"attributes", attributes}, {"indices", file.indices(mesh.indices)}, {"material", material}};
}

using MakePrimitive = std::function<nlohmann::json(GltfText&, const PlainMesh&, int)>;

inline GltfText tree_of(const MakePrimitive& primitive) {
    GltfText file = tree_around();
    file.mesh(primitive(file, plain_trunk(), 0), "trunk");
    file.mesh(primitive(file, plain_leaves(), 1), "leaves");
    return file;
}

inline void require(GltfText& file, const std::string& extension) {
    file.json["extensionsUsed"].push_back(extension);
    file.json["extensionsRequired"].push_back(extension);
}

/// A primitive as libdraco packs it, by either of its methods.
inline nlohmann::json draco_primitive(GltfText& file, const PlainMesh& plain, int material, bool sequential) {
    draco::Mesh mesh;
    const auto vertices = std::uint32_t(plain.vertices());
    mesh.set_num_points(vertices);
    nlohmann::json accessors, identifiers;
    const auto add = [&](draco::GeometryAttribute::Type type, const std::string& name, const std::vector<float>& values,
                         std::size_t components) {
        draco::GeometryAttribute description;
        description.Init(type, nullptr, std::uint8_t(components), draco::DT_FLOAT32, false,
                         std::int64_t(components * sizeof(float)), 0);
        const int id = mesh.AddAttribute(description, true, vertices);
        for (std::uint32_t v = 0; v < vertices; ++v)
            mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), &values[v * components]);
        identifiers[name] = mesh.attribute(id)->unique_id();
        file.json["accessors"].push_back(
            {{"componentType", 5126}, {"count", vertices}, {"type", components == 2 ? "VEC2" : "VEC3"}});
        accessors[name] = file.json["accessors"].size() - 1;
    };
    add(draco::GeometryAttribute::POSITION, "POSITION", plain.positions, 3);
    add(draco::GeometryAttribute::NORMAL, "NORMAL", plain.normals, 3);
    add(draco::GeometryAttribute::TEX_COORD, "TEXCOORD_0", plain.uvs, 2);
    for (std::size_t i = 0; i < plain.indices.size(); i += 3)
        mesh.AddFace({draco::PointIndex(plain.indices[i]), draco::PointIndex(plain.indices[i + 1]),
                      draco::PointIndex(plain.indices[i + 2])});
    draco::Encoder encoder;
    encoder.SetEncodingMethod(sequential ? draco::MESH_SEQUENTIAL_ENCODING : draco::MESH_EDGEBREAKER_ENCODING);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 10);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::TEX_COORD, 12);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok())
        throw std::runtime_error("libdraco could not encode a small mesh");
    const int view = file.view(std::vector<char>(buffer.data(), buffer.data() + buffer.size()));
    file.json["accessors"].push_back({{"componentType", 5123}, {"count", plain.indices.size()}, {"type", "SCALAR"}});
    return {{"attributes", accessors},
            {"indices", file.json["accessors"].size() - 1},
            {"material", material},
            {"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", identifiers}}}}}};
}

/// A buffer view that libmeshoptimizer packed; `values` are `count` elements of `stride` bytes, already filtered.
inline int meshopt_view(GltfText& file, const std::vector<unsigned char>& values, std::size_t count, std::size_t stride,
                        const std::string& mode, const std::string& filter = "NONE") {
    std::vector<unsigned char> packed;
    if (mode == "ATTRIBUTES") {
        packed.resize(meshopt_encodeVertexBufferBound(count, stride));
        packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), values.data(), count, stride));
    } else {
        std::vector<unsigned> indices(count);
        for (std::size_t i = 0; i < count; ++i)
            indices[i] = stride == 2 ? *reinterpret_cast<const std::uint16_t*>(&values[2 * i])
                                     : *reinterpret_cast<const std::uint32_t*>(&values[4 * i]);
        if (mode == "TRIANGLES") {
            packed.resize(meshopt_encodeIndexBufferBound(count, 65536));
            packed.resize(meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), count));
        } else {
            packed.resize(meshopt_encodeIndexSequenceBound(count, 65536));
            packed.resize(meshopt_encodeIndexSequence(packed.data(), packed.size(), indices.data(), count));
        }
    }
    const int view = file.view(packed);
    nlohmann::json& entry = file.json["bufferViews"][std::size_t(view)];
    // The view points into a buffer without data, which a reader of the extension has no need of.
    if (file.more_buffers.empty())
        file.more_buffers.push_back(
            {{"byteLength", 0}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
    const std::size_t offset = file.more_buffers[0]["byteLength"].get<std::size_t>(),
                      length = (count * stride + 3) / 4 * 4;
    file.more_buffers[0]["byteLength"] = offset + length;
    entry["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                      {"byteOffset", entry["byteOffset"]},
                                                      {"byteLength", packed.size()},
                                                      {"byteStride", stride},
                                                      {"count", count},
                                                      {"mode", mode},
                                                      {"filter", filter}};
    entry["buffer"] = 1;
    entry["byteOffset"] = offset;
    entry["byteLength"] = count * stride;
    if (mode == "ATTRIBUTES")
        entry["byteStride"] = stride;
    return view;
}

template <typename Value>
std::vector<unsigned char> as_bytes(const std::vector<Value>& values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    return {bytes, bytes + values.size() * sizeof(Value)};
}

inline int accessor_of(GltfText& file, int view, std::size_t count, int component_type, const std::string& type,
                       bool normalized = false) {
    file.json["accessors"].push_back(
        {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
    if (normalized)
        file.json["accessors"].back()["normalized"] = true;
    return int(file.json["accessors"].size()) - 1;
}

/// Packed as they are, or through filters: positions exponential, normals octahedral.
inline nlohmann::json meshopt_primitive(GltfText& file, const PlainMesh& plain, int material, bool filtered) {
    const std::size_t n = plain.vertices();
    nlohmann::json attributes;
    std::vector<unsigned char> positions = as_bytes(plain.positions);
    if (filtered)
        meshopt_encodeFilterExp(positions.data(), n, 12, 15, plain.positions.data());
    attributes["POSITION"] = accessor_of(
        file, meshopt_view(file, positions, n, 12, "ATTRIBUTES", filtered ? "EXPONENTIAL" : "NONE"), n, 5126, "VEC3");
    if (filtered) {
        std::vector<float> normals; // the filter takes four components
        for (std::size_t i = 0; i < n; ++i)
            normals.insert(normals.end(),
                           {plain.normals[3 * i], plain.normals[3 * i + 1], plain.normals[3 * i + 2], 0.f});
        std::vector<unsigned char> packed(4 * n);
        meshopt_encodeFilterOct(packed.data(), n, 4, 8, normals.data());
        attributes["NORMAL"] =
            accessor_of(file, meshopt_view(file, packed, n, 4, "ATTRIBUTES", "OCTAHEDRAL"), n, 5120, "VEC3", true);
    } else {
        attributes["NORMAL"] =
            accessor_of(file, meshopt_view(file, as_bytes(plain.normals), n, 12, "ATTRIBUTES"), n, 5126, "VEC3");
    }
    attributes["TEXCOORD_0"] =
        accessor_of(file, meshopt_view(file, as_bytes(plain.uvs), n, 8, "ATTRIBUTES"), n, 5126, "VEC2");
    const std::size_t count = plain.indices.size();
    const int indices =
        accessor_of(file, meshopt_view(file, as_bytes(plain.indices), count, 2, filtered ? "INDICES" : "TRIANGLES"),
                    count, 5123, "SCALAR");
    return {{"attributes", attributes}, {"indices", indices}, {"material", material}};
}

/// KHR_mesh_quantization: positions of 16 bits normalised over 4 m (the node scales them back), normals of 8 bits,
/// texture coordinates of 16 bits normalised.
inline nlohmann::json quantised_primitive(GltfText& file, const PlainMesh& plain, int material) {
    std::vector<std::int16_t> positions;
    std::vector<std::int8_t> normals;
    std::vector<std::uint16_t> uvs;
    const auto rounded = [](float value, float top) { return int(std::lround(value * top)); };
    for (std::size_t i = 0; i < plain.vertices(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            positions.push_back(std::int16_t(rounded(plain.positions[3 * i + c] / 4, 32767)));
            normals.push_back(std::int8_t(rounded(plain.normals[3 * i + c], 127)));
        }
        positions.push_back(0); // strides of 8 and 4
        normals.push_back(0);
        for (std::size_t c = 0; c < 2; ++c)
            uvs.push_back(std::uint16_t(rounded(plain.uvs[2 * i + c], 65535)));
    }
    const std::size_t n = plain.vertices();
    const int position_view = file.view(positions), normal_view = file.view(normals), uv_view = file.view(uvs);
    file.json["bufferViews"][std::size_t(position_view)]["byteStride"] = 8;
    file.json["bufferViews"][std::size_t(normal_view)]["byteStride"] = 4;
    nlohmann::json attributes;
    attributes["POSITION"] = accessor_of(file, position_view, n, 5122, "VEC3", true);
    attributes["NORMAL"] = accessor_of(file, normal_view, n, 5120, "VEC3", true);
    attributes["TEXCOORD_0"] = accessor_of(file, uv_view, n, 5123, "VEC2", true);
    return {{"attributes", attributes}, {"indices", file.indices(plain.indices)}, {"material", material}};
}

/// Positions are sparse over nothing, normals over false ones: every element is replaced.
inline nlohmann::json sparse_primitive(GltfText& file, const PlainMesh& plain, int material) {
    nlohmann::json primitive = plain_primitive(file, plain, material);
    const std::size_t n = plain.vertices();
    std::vector<std::uint32_t> every;
    for (std::size_t i = 0; i < n; ++i)
        every.push_back(std::uint32_t(i));
    for (const std::string name : {"POSITION", "NORMAL"}) {
        nlohmann::json& accessor = file.json["accessors"][primitive["attributes"][name].get<std::size_t>()];
        const auto values = accessor["bufferView"];
        if (name == "POSITION")
            accessor.erase("bufferView");
        else
            accessor["bufferView"] = file.view(std::vector<float>(3 * n, 7.f));
        accessor["sparse"] = {{"count", n},
                              {"indices", {{"bufferView", file.view(every)}, {"componentType", 5125}}},
                              {"values", {{"bufferView", values}}}};
    }
    return primitive;
}

/// Position, normal and texture coordinate side by side, 32 bytes a vertex; indices of 8 bits.
inline nlohmann::json interleaved_primitive(GltfText& file, const PlainMesh& plain, int material) {
    const std::size_t n = plain.vertices();
    std::vector<float> rows;
    for (std::size_t i = 0; i < n; ++i) {
        rows.insert(rows.end(), plain.positions.begin() + std::ptrdiff_t(3 * i),
                    plain.positions.begin() + std::ptrdiff_t(3 * i + 3));
        rows.insert(rows.end(), plain.normals.begin() + std::ptrdiff_t(3 * i),
                    plain.normals.begin() + std::ptrdiff_t(3 * i + 3));
        rows.insert(rows.end(), plain.uvs.begin() + std::ptrdiff_t(2 * i),
                    plain.uvs.begin() + std::ptrdiff_t(2 * i + 2));
    }
    const int view = file.view(rows);
    file.json["bufferViews"][std::size_t(view)]["byteStride"] = 32;
    nlohmann::json attributes;
    attributes["POSITION"] = accessor_of(file, view, n, 5126, "VEC3");
    attributes["NORMAL"] = accessor_of(file, view, n, 5126, "VEC3");
    file.json["accessors"].back()["byteOffset"] = 12;
    attributes["TEXCOORD_0"] = accessor_of(file, view, n, 5126, "VEC2");
    file.json["accessors"].back()["byteOffset"] = 24;
    const std::vector<std::uint8_t> small(plain.indices.begin(), plain.indices.end());
    return {{"attributes", attributes}, {"indices", file.accessor(small, "SCALAR", 1, 5121)}, {"material", material}};
}

/// No indices: every triangle has corners of its own.
inline nlohmann::json unindexed_primitive(GltfText& file, const PlainMesh& plain, int material) {
    PlainMesh corners;
    for (const std::uint16_t i : plain.indices) {
        corners.positions.insert(corners.positions.end(), &plain.positions[3 * i], &plain.positions[3 * i] + 3);
        corners.normals.insert(corners.normals.end(), &plain.normals[3 * i], &plain.normals[3 * i] + 3);
        corners.uvs.insert(corners.uvs.end(), &plain.uvs[2 * i], &plain.uvs[2 * i] + 2);
    }
    corners.indices = {0, 1, 2};
    nlohmann::json primitive = plain_primitive(file, corners, material);
    primitive.erase("indices");
    return primitive;
}

/// The trunk as a strip with indices of 32 bits, each card as a fan.
inline GltfText tree_of_strips_and_fans() {
    GltfText file = tree_around();
    const PlainMesh trunk = plain_trunk(), leaves = plain_leaves();
    nlohmann::json strip = plain_primitive(file, trunk, 0);
    std::vector<std::uint32_t> zigzag;
    for (std::uint32_t i = 0; i < 7; ++i)
        zigzag.insert(zigzag.end(), {i + 7, i}); // (7, 0, 8): the first diagonal runs as in the plain tree's other half
    strip["indices"] = file.accessor(zigzag, "SCALAR", 1, 5125);
    strip["mode"] = 5;
    file.mesh(strip, "trunk");
    nlohmann::json fan = plain_primitive(file, leaves, 1);
    fan["mode"] = 6;
    file.mesh(fan, "leaves");
    nlohmann::json& primitives = file.json["meshes"][1]["primitives"];
    primitives = nlohmann::json::array();
    for (std::uint16_t card = 0; card < 12; ++card) {
        const auto first = std::uint16_t(4 * card);
        fan["indices"] =
            file.indices({first, std::uint16_t(first + 1), std::uint16_t(first + 2), std::uint16_t(first + 3)});
        primitives.push_back(fan);
    }
    return file;
}

/// One card, twelve instances; rotations as floats, or packed by meshopt's quaternion filter.
inline GltfText tree_of_instances(bool packed) {
    GltfText file = tree_around();
    file.mesh(plain_primitive(file, plain_trunk(), 0), "trunk");
    file.mesh(plain_primitive(file, plain_card(), 1), "card");
    std::vector<float> translations, rotations, scales;
    for (const CardPlace& place : card_places()) {
        translations.insert(translations.end(), place.translation, place.translation + 3);
        rotations.insert(rotations.end(), {0.f, std::sin(place.angle / 2), 0.f, std::cos(place.angle / 2)});
        scales.insert(scales.end(), {place.scale, place.scale, place.scale});
    }
    nlohmann::json attributes;
    attributes["TRANSLATION"] = file.accessor(translations, "VEC3", 3, 5126);
    if (packed) {
        std::vector<unsigned char> bytes(8 * 12);
        meshopt_encodeFilterQuat(bytes.data(), 12, 8, 16, rotations.data());
        attributes["ROTATION"] =
            accessor_of(file, meshopt_view(file, bytes, 12, 8, "ATTRIBUTES", "QUATERNION"), 12, 5122, "VEC4", true);
        require(file, "EXT_meshopt_compression");
    } else {
        attributes["ROTATION"] = file.accessor(rotations, "VEC4", 4, 5126);
    }
    attributes["SCALE"] = file.accessor(scales, "VEC3", 3, 5126);
    file.json["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
    require(file, "EXT_mesh_gpu_instancing");
    return file;
}

inline GltfText tree_with_webp() {
    GltfText file = tree_of(plain_primitive);
    file.json["images"].push_back({{"mimeType", "image/webp"}});
    file.json["images"][1]["bufferView"] = file.view(leaf_webp());
    file.json["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}}};
    require(file, "EXT_texture_webp");
    return file;
}

/// Quads, half of the cards with indices from the end; v upwards.
inline FileKind tree_as_obj() {
    std::string text = "# a tree\nmtllib two words.mtl\n";
    char line[128];
    const auto add_mesh = [&](const PlainMesh& mesh, bool relative, std::size_t first, const char* name,
                              const char* material, const std::vector<std::vector<std::size_t>>& faces) {
        for (std::size_t i = 0; i < mesh.vertices(); ++i) {
            std::snprintf(line, sizeof line, "v %.7g %.7g %.7g\nvn %.7g %.7g %.7g\nvt %.7g %.7g\n",
                          double(mesh.positions[3 * i]), double(mesh.positions[3 * i + 1]),
                          double(mesh.positions[3 * i + 2]), double(mesh.normals[3 * i]),
                          double(mesh.normals[3 * i + 1]), double(mesh.normals[3 * i + 2]), double(mesh.uvs[2 * i]),
                          double(1 - mesh.uvs[2 * i + 1]));
            text += line;
        }
        text += std::string("o ") + name + "\nusemtl " + material + "\n";
        for (const auto& face : faces) {
            text += "f";
            for (const std::size_t corner : face) {
                const std::string index =
                    relative ? "-" + std::to_string(mesh.vertices() - corner) : std::to_string(first + corner + 1);
                text += " " + index + "/" + index + "/" + index;
            }
            text += "\n";
        }
    };
    std::vector<std::vector<std::size_t>> sides, cards;
    for (std::size_t i = 0; i < 6; ++i)
        sides.push_back({i + 8, i + 7, i, i + 1});
    for (std::size_t i = 0; i < 12; ++i)
        cards.push_back({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
    add_mesh(plain_trunk(), false, 0, "trunk", "bark", sides);
    add_mesh(plain_leaves(), true, 14, "leaves", "leaf", cards);
    const std::vector<unsigned char> png = leaf_png();
    FileKind kind{"obj", "tree.obj", {}, 2e-6f};
    kind.files["tree.obj"] = text;
    kind.files["two words.mtl"] = "newmtl bark\nKd 0.6 0.5 0.35\nd 1\n\nnewmtl leaf\nKd 1 1 1\nmap_Kd leaf.png\n"
                                  "map_d leaf.png\n";
    kind.files["leaf.png"] = std::string(png.begin(), png.end());
    return kind;
}

/// Every kind. The first is the plain twin of all others.
inline std::vector<FileKind> all_file_kinds() {
    std::vector<FileKind> kinds;
    const auto add = [&](const std::string& name, const GltfText& file, float tolerance = 1e-6f) {
        kinds.push_back({name, "tree.gltf", {{"tree.gltf", file.text()}}, tolerance});
    };
    const GltfText plain = tree_of(plain_primitive);
    add("data URI", plain);
    kinds.push_back({"binary", "tree.glb", {{"tree.glb", plain.glb()}}});
    kinds.push_back({"external buffer",
                     "tree.gltf",
                     {{"tree.gltf", plain.text_beside("parts/my%20b%C3%A4ume.bin")},
                      {"parts/my b\xc3\xa4ume.bin", std::string(plain.bytes.begin(), plain.bytes.end())}}});
    for (const bool sequential : {false, true}) {
        GltfText file = tree_of(
            [&](GltfText& f, const PlainMesh& m, int material) { return draco_primitive(f, m, material, sequential); });
        require(file, "KHR_draco_mesh_compression");
        add(sequential ? "draco, sequential" : "draco, edgebreaker", file, 5e-3f);
    }
    for (const bool filtered : {false, true}) {
        GltfText file = tree_of(
            [&](GltfText& f, const PlainMesh& m, int material) { return meshopt_primitive(f, m, material, filtered); });
        require(file, "EXT_meshopt_compression");
        add(filtered ? "meshopt, filtered" : "meshopt", file, filtered ? 0.02f : 1e-6f);
    }
    GltfText quantised = tree_of(quantised_primitive);
    for (std::size_t node = 0; node < 2; ++node)
        quantised.json["nodes"][node]["scale"] = {4, 4, 4};
    require(quantised, "KHR_mesh_quantization");
    add("quantised", quantised, 0.01f);
    add("sparse", tree_of(sparse_primitive));
    add("interleaved", tree_of(interleaved_primitive));
    add("without indices", tree_of(unindexed_primitive));
    add("strips and fans", tree_of_strips_and_fans());
    add("instances", tree_of_instances(false), 1e-5f);
    add("instances, packed", tree_of_instances(true), 2e-4f);
    add("WebP", tree_with_webp());
    kinds.push_back(tree_as_obj());
    return kinds;
}

} // namespace kokage
