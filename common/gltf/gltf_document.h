#pragma once
// A glTF 2.0 file (.glb or .gltf) in memory, checked before anything is decoded or allocated from its counts.
#include "common/services/progress.h"
#include "common/types.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace kokage {

/// A loaded file. Every index, range and count that the accessors use has been checked against the file's own sizes:
/// accessors that reach beyond their buffer never get here. Compressed geometry (Draco, meshopt) has been decoded.
class GltfDocument {
  public:
    /// Reads a file and its external buffers; images are read when they are asked for. Throws InputError (one line that
    /// begins with the path) when the file is missing, cut off or inconsistent, or when it requires an extension that
    /// is not understood: that one is named, and nothing of the file is decoded.
    static GltfDocument read(const std::filesystem::path& path, Progress& progress = silent_progress());
    ~GltfDocument();
    GltfDocument(GltfDocument&&) noexcept;
    GltfDocument& operator=(GltfDocument&&) noexcept;

    /// What tinygltf makes of the file, without images, animations and extras. Accessors that no buffer view gives data
    /// hold zeros, which sparse values may replace.
    const tinygltf::Model& model() const;
    const nlohmann::json& json() const; ///< the file's JSON as written, for `extras`
    const std::string& path() const;

    /// The `extras` of the whole file; null if there are none.
    const nlohmann::json& extras() const;

    /// An accessor's elements as floats, `components` an element (normalised integers become 0..1 or -1..1, sparse
    /// values applied). Throws InputError if the accessor does not exist or has another number of components.
    std::vector<float> floats(int accessor, int components) const;
    /// A SCALAR accessor of unsigned bytes, shorts or ints.
    std::vector<std::uint32_t> unsigned_integers(int accessor) const;
    std::size_t accessor_count(int accessor) const; ///< elements; throws InputError if there is no such accessor

    std::size_t image_count() const;
    /// The encoded bytes of an image (PNG, JPEG, WebP, KTX2, ...). Throws InputError if there is no such image, or its
    /// file can't be read.
    std::span<const unsigned char> image_bytes(int image) const;

    /// Throws InputError: "<path>: <what>".
    [[noreturn]] void fail(const std::string& what) const;

  private:
    /// Refuses an accessor without a buffer view that has more elements than the file has bytes.
    void check_data(int accessor) const;
    struct Implementation;
    explicit GltfDocument(std::unique_ptr<Implementation> implementation);
    std::unique_ptr<Implementation> implementation_;
};

/// Extensions that a file may require and that are understood (or that don't change shape and diffuse colour).
std::span<const std::string_view> understood_gltf_extensions();

} // namespace kokage
