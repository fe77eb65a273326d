#pragma once
// The corners of an outline. Up to eight (a Box2D polygon has no more) are stored inline, so that copying outlines
// every frame allocates no memory; more go to the heap. It has the part of std::vector's interface that is needed here.

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <vector>

namespace supercircle::contact {

class OutlinePoints {
public:
    using value_type = Eigen::Vector2d;

    OutlinePoints() { few_.fill(value_type::Zero()); }
    OutlinePoints(std::initializer_list<value_type> points) : OutlinePoints() {
        for (const value_type& p : points)
            push_back(p);
    }

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    [[nodiscard]] value_type* begin() { return data(); }
    [[nodiscard]] value_type* end() { return data() + size_; }
    [[nodiscard]] const value_type* begin() const { return data(); }
    [[nodiscard]] const value_type* end() const { return data() + size_; }
    value_type& operator[](std::size_t i) { return data()[i]; }
    const value_type& operator[](std::size_t i) const { return data()[i]; }
    value_type& front() { return data()[0]; }
    [[nodiscard]] const value_type& front() const { return data()[0]; }
    value_type& back() { return data()[size_ - 1]; }
    [[nodiscard]] const value_type& back() const { return data()[size_ - 1]; }

    void clear() {
        size_ = 0;
        many_.clear();
    }
    void push_back(const value_type& p) {
        if (size_ < kFew) {
            few_[size_++] = p;
            return;
        }
        if (size_ == kFew)
            many_.assign(few_.begin(), few_.end());
        many_.push_back(p);
        ++size_;
    }
    void assign(std::size_t count, const value_type& p) {
        clear();
        for (std::size_t i = 0; i < count; ++i)
            push_back(p);
    }

    friend bool operator==(const OutlinePoints& a, const OutlinePoints& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end());
    }

private:
    static constexpr std::size_t kFew = 8;
    [[nodiscard]] value_type* data() { return size_ <= kFew ? few_.data() : many_.data(); }
    [[nodiscard]] const value_type* data() const { return size_ <= kFew ? few_.data() : many_.data(); }

    std::size_t size_ = 0;
    std::array<value_type, kFew> few_;
    std::vector<value_type> many_; ///< all corners, if there are more than kFew
};

} // namespace supercircle::contact
