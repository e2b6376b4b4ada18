#include "tact/bench/studies.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tact/bench/report.hpp"
#include "tact/lib/errors.hpp"
#include "tact/lib/io/write_file.hpp"

namespace tact::bench {
namespace {

class Studies : public testing::Test {
protected:
    Studies() {
        folder_ = std::filesystem::path(testing::TempDir()) / "tact_studies_test";
        std::filesystem::remove_all(folder_);
    }
    ~Studies() override { std::filesystem::remove_all(folder_); }
    std::string read(const std::string& name) const {
        std::ifstream file(folder_ / name);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    std::filesystem::path folder_;
};

TEST_F(Studies, FinishedOnesAreKeptAndThePageShowsWhatTheirJsonSays) {
    const AllOptions options{{.small = true, .repeats = 1}, folder_, false, {"speedup"}};
    testing::internal::CaptureStdout();
    ASSERT_EQ(run_all(options), 0);
    Json json = Json::parse(read("speedup.json"));
    EXPECT_GT(json["study_seconds"], 0);
    json["rows"][0]["speedup"] = 123456.0;
    write_file(folder_ / "speedup.json", json.dump());
    EXPECT_EQ(run_all(options), 0);
    EXPECT_NE(testing::internal::GetCapturedStdout().find("speedup: kept"), std::string::npos);
    write_page(folder_);
    const std::string page = read("index.html");
    EXPECT_NE(page.find("120\u2009000"), std::string::npos) << "two digits of the number put into the json";
    EXPECT_NE(page.find("<svg"), std::string::npos);
    EXPECT_EQ(page.find("http://localhost"), std::string::npos);
    EXPECT_NE(page.find("tact-bench all --only stability"), std::string::npos) << "what was not run is said";
}

TEST_F(Studies, OtherNamesAreRejected) {
    EXPECT_THROW(run_all({{}, folder_, false, {"speedup", "speeddown"}}), InputError);
    EXPECT_THROW(write_page(folder_), NumericalError) << "nothing to make a page of";
}

}  // namespace
}  // namespace tact::bench
