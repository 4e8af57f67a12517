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
/// accessors that reach beyond their buffer never get here.
class GltfDocument {
  public:
    /// Reads a file and its external buffers and images. Throws InputError (one line that begins with the path) when
    /// the file is missing, cut off or inconsistent, or when it requires an extension that is not understood: that one
    /// is named, and nothing of the file is decoded.
    static GltfDocument read(const std::filesystem::path& path, Progress& progress = silent_progress());
    ~GltfDocument();
    GltfDocument(GltfDocument&&) noexcept;
    GltfDocument& operator=(GltfDocument&&) noexcept;

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

    /// The encoded bytes of an image (PNG, JPEG, WebP). Throws InputError if its file could not be read.
    std::span<const unsigned char> image_bytes(int image) const;

    /// Throws InputError: "<path>: <what>".
    [[noreturn]] void fail(const std::string& what) const;

  private:
    struct Implementation;
    explicit GltfDocument(std::unique_ptr<Implementation> implementation);
    std::unique_ptr<Implementation> implementation_;
};

/// Extensions that a file may require and that are understood (or that don't change shape and diffuse colour).
std::span<const std::string_view> understood_gltf_extensions();

} // namespace kokage
