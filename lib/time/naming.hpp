// Names with options, as the registry reads them.
#pragma once

#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <utility>

namespace tact {

/// The fewest digits that read back as the same number.
inline std::string short_number(double x) {
    std::array<char, 32> digits{};
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr};
}

/// "trapezoid", "trapezoid:rho=0.5,e=0": a name that options are added to.
class WithOptions {
public:
    explicit WithOptions(std::string name) : text_(std::move(name)) {}
    WithOptions& add(std::string_view option, double value) {
        text_ += first_ ? ':' : ',';
        first_ = false;
        text_.append(option).append("=").append(short_number(value));
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
