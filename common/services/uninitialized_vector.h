#pragma once
// A vector whose resize() leaves new elements as they are: for buffers that are written whole before they are read,
// where filling them with zeros first would be a second trip through memory.
#include <memory>
#include <utility>
#include <vector>

namespace kokage {

template <class T>
struct DefaultInitAllocator : std::allocator<T> {
    template <class U>
    struct rebind {
        using other = DefaultInitAllocator<U>;
    };
    template <class U>
    void construct(U* place) {
        ::new (static_cast<void*>(place)) U;
    }
    template <class U, class... Arguments>
    void construct(U* place, Arguments&&... arguments) {
        ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
    }
};

template <class T>
using UninitializedVector = std::vector<T, DefaultInitAllocator<T>>;

} // namespace kokage
