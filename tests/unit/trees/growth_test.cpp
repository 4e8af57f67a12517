#include "common/services/error.h"
#include "common/services/parallel.h"
#include "trees/growth.h"

#include <cstring>
#include <gtest/gtest.h>

namespace kokage {
namespace {

template <class T>
std::uint64_t hash_bytes(std::uint64_t hash, const std::vector<T>& values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (std::size_t i = 0; i < values.size() * sizeof(T); ++i)
        hash = (hash ^ bytes[i]) * 1099511628211ull;
    return hash;
}

std::uint64_t hash_of(const Tree& tree) {
    std::uint64_t hash = 14695981039346656037ull;
    for (const TreePart& part : tree.parts) {
        hash = hash_bytes(hash, part.positions);
        hash = hash_bytes(hash, part.normals);
        hash = hash_bytes(hash, part.uvs);
        hash = hash_bytes(hash, part.triangles);
        hash = hash_bytes(hash, part.triangle_patch);
    }
    for (const Branch& branch : tree.skeleton.branches)
        hash = hash_bytes(hash, branch.nodes);
    return hash_bytes(hash, tree.leaves);
}

GrowthParameters oak_with(int leaves, std::uint64_t seed = 1) {
    GrowthParameters parameters = oak_parameters();
    parameters.leaves = leaves;
    parameters.seed = seed;
    return parameters;
}

TEST(Growth, SameSeedGivesSameBytesWithAnyNumberOfThreads) {
    std::vector<std::uint64_t> hashes;
    for (const int threads : {1, 2, 5}) {
        set_thread_count(threads);
        hashes.push_back(hash_of(grow(oak_with(3000))));
    }
    set_thread_count(0);
    EXPECT_EQ(hashes[0], hashes[1]);
    EXPECT_EQ(hashes[0], hashes[2]);
    EXPECT_NE(hashes[0], hash_of(grow(oak_with(3000, 2)))) << "another seed is another tree";
}

} // namespace
} // namespace kokage
