// A handle on an immutable object: what is handed over lives as long as anyone who took it.
#pragma once

#include <concepts>
#include <memory>
#include <type_traits>
#include <typeinfo>
#include <utility>

#include "errors.hpp"

namespace tact {

/// A shared_ptr<const T> that also takes an object of a class derived from T by value: a copy of an lvalue, the temporary
/// itself. Functions and members of this type accept `Trapezoid{}` as well as `std::make_shared<Trapezoid>()`, and nothing
/// has to outlive them. An object that is known by its abstract base only goes in by shared_ptr.
template <class T> class Shared : public std::shared_ptr<const T> {
    using Base = std::shared_ptr<const T>;

public:
    using Base::Base;
    Shared() = default;
    Shared(Base pointer) : Base(std::move(pointer)) {}  // NOLINT: the same thing
    /// InputError if the object's own class is derived from the one it is known by: the copy would lack the difference.
    template <class D>
    requires(std::derived_from<std::remove_cvref_t<D>, T> && !std::is_abstract_v<std::remove_cvref_t<D>>)
        Shared(D&& object)
        : Base(whole<std::remove_cvref_t<D>>(std::forward<D>(object))) {}  // NOLINT: a value of it

    /// A handle on an object that the caller keeps alive as long as the handle: no copy is made.
    static Shared borrowed(const T& object) { return Base(std::shared_ptr<void>(), &object); }

private:
    template <class D, class Given> static Base whole(Given&& object) {
        if constexpr (std::is_polymorphic_v<D>)
            if (typeid(object) != typeid(D))
                throw InputError(
                    "Shared: the object is of a class derived from the one given, expected a shared_ptr to it");
        return std::make_shared<const D>(std::forward<Given>(object));
    }
};

}  // namespace tact
