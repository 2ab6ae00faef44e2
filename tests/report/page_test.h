// Tests of a report's page: one folder and one browser for all of a suite, and no complaint of the browser.
#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "host/report/report.h"
#include "tests/io/folder.h"
#include "tests/report/browser.h"
#include "tests/report/sample_folder.h"

namespace forceshade::testing {

/// For open(): a browser without WebGL.
inline constexpr const char* kNoWebGl =
    "{ const old = HTMLCanvasElement.prototype.getContext; HTMLCanvasElement.prototype.getContext = "
    "function(kind, ...more) { return /webgl/.test(kind) ? null : old.call(this, kind, ...more); }; }";

class ReportPage : public ::testing::Test {
protected:
    /// To be called once what is reported stands in folder_.
    static void begin() {
        report::write_report(folder_->path());
        browser_ = std::make_unique<Browser>();
    }
    static void TearDownTestSuite() {
        browser_.reset();
        folder_ = std::make_unique<Folder>();
    }
    void TearDown() override { EXPECT_EQ(browser_->complaints(), std::vector<std::string>{}); }

    static void open(unsigned width = 1200, bool dark = false, const std::string& before = {}) {
        browser_->open(folder_->path() / "report.html", width, dark, before);
        ASSERT_TRUE(browser_->wait_for("document.documentElement.dataset.viewer === 'ready'"))
            << browser_->text("document.getElementById('viewer-status').textContent");
    }
    /// As the read-out has it: row 0: A, 1: B, 2: their difference; column 1: |F|.
    static std::string read(int row, int column = 1) {
        return browser_->text("document.getElementById('read-rows').children[" + std::to_string(row) + "].children[" +
                              std::to_string(column) + "].textContent.replace('−', '-')");
    }
    static double number(int row, int column = 1) { return std::stod(read(row, column)); }

    static inline std::unique_ptr<Folder> folder_ = std::make_unique<Folder>();
    static inline std::unique_ptr<Browser> browser_;
};

} // namespace forceshade::testing
