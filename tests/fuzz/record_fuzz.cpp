// JSON of a case and of a study: what is understood is written and read as the same, its tables as CSV too.
#include <nlohmann/json.hpp>

#include "host/output/record.h"
#include "host/paths/path_reader.h"
#include "host/study/data/data_files.h"
#include "tests/fuzz/fuzz.h"

namespace forceshade {
namespace {

using fuzz::require;
using Json = nlohmann::ordered_json;

void check_case(const Json& json) {
    const std::optional<CaseRecord> record = record_of(json);
    if (!record)
        return;
    complaint(*record);
    const std::string text = record_json(*record);
    const std::optional<CaseRecord> again = record_of(Json::parse(text));
    require(again.has_value(), "a record cannot be read again");
    require(record_json(*again) == text, "a record becomes another");
}

void check_csv(const study::Table& table) {
    static fuzz::MemoryFile file;
    file.write(study::table_csv(table));
    CsvReader reader(file.path());
    // A line of one empty cell is an empty one, which readers skip; a mark at the beginning of the file is none of its
    // text.
    const bool marked = !table.columns.empty() && table.columns[0].name.starts_with("\xEF\xBB\xBF");
    if (table.columns.size() < 2 || marked)
        return;
    require(reader.next() && reader.size() == table.columns.size(), "the header has {} cells", reader.size());
    for (std::size_t i = 0; i < reader.size(); ++i)
        require(reader.text(i) == table.columns[i].name, "the column \"{}\" is called \"{}\"", table.columns[i].name,
                reader.text(i));
    for (const std::vector<study::Cell>& row : table.rows) {
        require(reader.next() && reader.size() == row.size(), "a row has {} cells", reader.size());
        for (std::size_t i = 0; i < row.size(); ++i)
            require(reader.text(i) == row[i].text(), "\"{}\" is read as \"{}\"", row[i].text(), reader.text(i));
    }
    require(!reader.next(), "there is more than the table");
}

void check_study(const Json& json) {
    study::StudyData data;
    try {
        data = study::parse_data(json);
    } catch (const study::DataError&) {
        return;
    }
    const std::string text = study::data_json(data);
    require(study::data_json(study::parse_data(Json::parse(text))) == text, "a study becomes another");
    for (const study::Table& table : data.tables)
        check_csv(table);
}

} // namespace
} // namespace forceshade

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto json = forceshade::Json::parse(data, data + size, nullptr, false);
    forceshade::check_case(json);
    forceshade::check_study(json);
    return 0;
}
