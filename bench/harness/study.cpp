#include "study.hpp"

namespace tact::bench {

std::vector<std::string> StudyArguments::list(const std::string& option) const {
    const auto found = given.find(option);
    return found == given.end() ? std::vector<std::string>() : found->second;
}

std::string StudyArguments::choice(const std::string& option, const std::string& otherwise) const {
    const std::vector<std::string> names = list(option);
    return names.empty() ? otherwise : names.front();
}

}  // namespace tact::bench
