#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace kokage {

/// Values of some of many places, as the camera sees few of a forest's leaves: 4 bytes a place, more where there is a
/// value.
template <typename Value>
class ValuesOfSome {
  public:
    explicit ValuesOfSome(std::size_t places = 0) : number_(places, 0) {}

    std::size_t places() const { return number_.size(); }
    /// Null where there is none.
    const Value* find(std::uint32_t place) const {
        return number_[place] != 0 ? &values_[number_[place] - 1] : nullptr;
    }
    /// Made of `arguments` where there is none.
    template <typename... Arguments>
    Value& at(std::uint32_t place, Arguments&&... arguments) {
        if (number_[place] == 0) {
            values_.emplace_back(std::forward<Arguments>(arguments)...);
            number_[place] = std::uint32_t(values_.size());
        }
        return values_[number_[place] - 1];
    }
    /// In the order in which they were made.
    std::vector<Value>& values() { return values_; }
    /// body(place, value) for all that there are, places in order.
    template <typename Body>
    void for_each(Body&& body) const {
        for (std::size_t place = 0; place < number_.size(); ++place)
            if (number_[place] != 0)
                body(std::uint32_t(place), values_[number_[place] - 1]);
    }
    std::size_t bytes() const {
        return number_.capacity() * sizeof(std::uint32_t) + values_.capacity() * sizeof(Value);
    }
    /// The most that bytes() may be with so many values: room doubles when it is full.
    static double most_bytes(double places, double values) {
        return places * double(sizeof(std::uint32_t)) + 2 * values * double(sizeof(Value));
    }

  private:
    std::vector<std::uint32_t> number_; ///< from 1; 0: none
    std::vector<Value> values_;
};

} // namespace kokage
