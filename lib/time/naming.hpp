// Names with options, as the registry reads them.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "../errors.hpp"

namespace tact {

/// "trapezoid", "trapezoid:rho=0.5,e=0": a name that options are added to.
class WithOptions {
public:
    explicit WithOptions(std::string name) : text_(std::move(name)) {}
    WithOptions& add(std::string_view option, double value) {
        text_ += first_ ? ':' : ',';
        first_ = false;
        text_.append(option).append("=").append(shown(value));
        return *this;
    }
    /// Only where it is not what it would be anyway.
    WithOptions& add_unless(double usual, std::string_view option, double value) {
        return value == usual ? *this : add(option, value);
    }
    const std::string& text() const { return text_; }

private:
    std::string text_;
    bool first_ = true;
};

}  // namespace tact
