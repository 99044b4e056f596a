// The lists of a result: arrays that share memory if their contents are equal, and arrays that are
// not stored if their items are evenly spaced. Most hulls with millions of facets are simplicial:
// their facets are their simplices, and all lists have the same length.
#pragma once

#include <algorithm>
#include <atomic>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <span>
#include <utility>

#include "cullhull/array.hpp"

#pragma GCC visibility push(default)
namespace cullhull::internal {

/// A random-access iterator over the values of a container's operator[], by value, because there
/// may be no stored item to refer to. Invalidated when the container moves or is destroyed.
template <class Container>
class IndexIterator {
 public:
  using reference = decltype(std::declval<const Container&>()[0]);
  using value_type = reference;
  using iterator_category = std::input_iterator_tag;  // references are no lvalues
  using iterator_concept = std::random_access_iterator_tag;
  using difference_type = std::ptrdiff_t;
  using pointer = void;

  IndexIterator() = default;
  IndexIterator(const Container* of, std::ptrdiff_t at) : of_(of), at_(at) {}
  reference operator*() const { return (*of_)[static_cast<std::size_t>(at_)]; }
  reference operator[](difference_type n) const {
    return (*of_)[static_cast<std::size_t>(at_ + n)];
  }
  IndexIterator& operator++() { return *this += 1; }
  IndexIterator& operator--() { return *this += -1; }
  IndexIterator operator++(int) { return std::exchange(*this, *this + 1); }
  IndexIterator operator--(int) { return std::exchange(*this, *this - 1); }
  IndexIterator& operator+=(difference_type n) {
    at_ += n;
    return *this;
  }
  IndexIterator& operator-=(difference_type n) { return *this += -n; }
  friend IndexIterator operator+(IndexIterator i, difference_type n) { return i += n; }
  friend IndexIterator operator+(difference_type n, IndexIterator i) { return i += n; }
  friend IndexIterator operator-(IndexIterator i, difference_type n) { return i += -n; }
  friend difference_type operator-(IndexIterator a, IndexIterator b) { return a.at_ - b.at_; }
  friend bool operator==(IndexIterator a, IndexIterator b) { return a.at_ == b.at_; }
  friend auto operator<=>(IndexIterator a, IndexIterator b) { return a.at_ <=> b.at_; }

 private:
  const Container* of_ = nullptr;
  std::ptrdiff_t at_ = 0;
};

}  // namespace cullhull::internal

namespace cullhull {

/// A read-only Array whose copies share memory. It behaves as a value: `edit` returns an array that
/// no copy shares. Thread safe as other values are: different threads may read, edit and destroy
/// copies that share memory.
template <class T>
class SharedArray {
 public:
  using value_type = T;
  using const_iterator = typename Array<T>::const_iterator;
  using iterator = const_iterator;

  SharedArray() = default;
  SharedArray(Array<T> items)  // NOLINT: an array converts
      : items_(std::make_shared<Array<T>>(std::move(items))) {}
  SharedArray(std::initializer_list<T> items) : SharedArray(Array<T>(items)) {}

  std::size_t size() const noexcept { return items_ ? items_->size() : 0; }
  bool empty() const noexcept { return size() == 0; }
  const T* data() const noexcept { return items_ ? items_->data() : nullptr; }
  const T& operator[](std::size_t i) const noexcept { return (*items_)[i]; }
  const T& front() const noexcept { return items_->front(); }
  const T& back() const noexcept { return items_->back(); }
  const_iterator begin() const noexcept { return items_ ? items_->cbegin() : const_iterator(); }
  const_iterator end() const noexcept { return items_ ? items_->cend() : const_iterator(); }
  operator std::span<const T>() const noexcept {
    return {data(), size()};
  }  // NOLINT: as vectors do

  /// The array, writable; other SharedArrays do not see the changes. Copies the items first if
  /// other SharedArrays share them. The reference is valid until this object is copied, assigned to
  /// or destroyed.
  Array<T>& edit() {
    if (!items_)
      items_ = std::make_shared<Array<T>>();
    else if (items_.use_count() > 1)
      items_ = std::make_shared<Array<T>>(*items_);
    else
      std::atomic_thread_fence(std::memory_order_acquire);  // after what the last sharer read
    return *items_;
  }

  /// Whether both share memory (and so are equal).
  bool shares(const SharedArray& other) const noexcept { return items_ == other.items_; }

  friend bool operator==(const SharedArray& a, const SharedArray& b) {
    return a.shares(b) || std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  std::shared_ptr<Array<T>> items_;  // nullptr: empty
};

/// A read-only Array of integers that are not stored if item i is i times a step.
template <class T>
class EvenArray {
 public:
  using value_type = T;
  using const_iterator = internal::IndexIterator<EvenArray>;
  using iterator = const_iterator;

  EvenArray() = default;
  EvenArray(Array<T> items)  // NOLINT: an array converts
      : items_(std::move(items)), count_(items_.size()), even_(false) {}
  EvenArray(std::initializer_list<T> items) {
    for (const T v : items) push_back(v);
  }
  EvenArray(const EvenArray&) = default;
  EvenArray& operator=(const EvenArray&) = default;
  /// `other` becomes empty.
  EvenArray(EvenArray&& other) noexcept { *this = std::move(other); }
  EvenArray& operator=(EvenArray&& other) noexcept {
    items_ = std::exchange(other.items_, {});
    count_ = std::exchange(other.count_, 0);
    step_ = std::exchange(other.step_, T{});
    even_ = std::exchange(other.even_, true);
    return *this;
  }
  /// The items 0, step, 2 step, ...: `count` of them.
  static EvenArray of_step(std::size_t count, T step) {
    EvenArray a;
    a.count_ = count;
    a.step_ = step;
    return a;
  }

  std::size_t size() const noexcept { return even_ ? count_ : items_.size(); }
  bool empty() const noexcept { return size() == 0; }
  T operator[](std::size_t i) const noexcept {
    return even_ ? static_cast<T>(i) * step_ : items_[i];
  }
  T front() const noexcept { return (*this)[0]; }
  T back() const noexcept { return (*this)[size() - 1]; }
  iterator begin() const noexcept { return {this, 0}; }
  iterator end() const noexcept { return {this, static_cast<std::ptrdiff_t>(size())}; }

  /// The step if the items are not stored, else nullptr.
  const T* step() const noexcept { return even_ ? &step_ : nullptr; }
  /// The items if they are stored, else nullptr.
  const T* data() const noexcept { return even_ ? nullptr : items_.data(); }

  /// Appends an item; the items are stored once they are no longer evenly spaced.
  void push_back(T v) {
    if (even_ && count_ == 1 && front() == 0) step_ = v;
    if (even_ && v == static_cast<T>(count_) * step_) {
      ++count_;
      return;
    }
    edit().push_back(v);
  }
  void clear() noexcept { *this = EvenArray(); }

  /// Stores the items if they are not stored yet, and returns them, writable.
  Array<T>& edit() {
    if (even_) {
      items_.resize(count_);
      for (std::size_t i = 0; i < count_; ++i) items_[i] = static_cast<T>(i) * step_;
      even_ = false;
    }
    return items_;
  }

  friend bool operator==(const EvenArray& a, const EvenArray& b) {
    if (a.size() != b.size()) return false;
    if (a.even_ && b.even_) return a.step_ == b.step_ || a.count_ < 2;
    return std::equal(a.begin(), a.end(), b.begin());
  }

 private:
  Array<T> items_;
  std::size_t count_ = 0;  // if even_
  T step_ = 0;
  bool even_ = true;
};

/// Concatenated lists: list i is items[offsets[i] .. offsets[i + 1]). If all have the same length,
/// the offsets use no memory. A range of spans: for (std::span<const T> list : lists).
template <class T, class Items = Array<T>>
struct Lists {
  using value_type = std::span<const T>;
  using const_iterator = internal::IndexIterator<Lists>;
  using iterator = const_iterator;

  EvenArray<std::uint64_t> offsets{0};
  Items items;

  /// Cuts `items` into lists of `length` > 0 items.
  static Lists of_length(std::uint64_t length, Items items) {
    Lists lists;
    lists.offsets = EvenArray<std::uint64_t>::of_step(items.size() / length + 1, length);
    lists.items = std::move(items);
    return lists;
  }

  /// 0 also after a move from this object.
  std::size_t size() const noexcept { return offsets.empty() ? 0 : offsets.size() - 1; }
  bool empty() const noexcept { return size() == 0; }
  std::span<const T> operator[](std::size_t i) const {
    return {items.data() + offsets[i], items.data() + offsets[i + 1]};
  }
  iterator begin() const noexcept { return {this, 0}; }
  iterator end() const noexcept { return {this, static_cast<std::ptrdiff_t>(size())}; }

  friend bool operator==(const Lists&, const Lists&) = default;
};

}  // namespace cullhull
#pragma GCC visibility pop
