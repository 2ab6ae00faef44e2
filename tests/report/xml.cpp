#include "tests/report/xml.h"

#include <memory>
#include <stdexcept>

#include <expat.h>

namespace forceshade::testing {
namespace {

struct Reading {
    std::vector<Element> elements;
    std::vector<std::size_t> open;
};

void start(void* data, const XML_Char* name, const XML_Char** attributes) {
    auto& reading = *static_cast<Reading*>(data);
    reading.open.push_back(reading.elements.size());
    Element element{name, {}, {}};
    for (; *attributes; attributes += 2)
        element.attributes[attributes[0]] = attributes[1];
    reading.elements.push_back(std::move(element));
}

void end(void* data, const XML_Char*) {
    static_cast<Reading*>(data)->open.pop_back();
}

void characters(void* data, const XML_Char* text, int length) {
    auto& reading = *static_cast<Reading*>(data);
    if (!reading.open.empty())
        reading.elements[reading.open.back()].text.append(text, static_cast<std::size_t>(length));
}

} // namespace

std::vector<Element> elements_of(std::string_view xml) {
    const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate("UTF-8"),
                                                                              &XML_ParserFree);
    Reading reading;
    XML_SetUserData(parser.get(), &reading);
    XML_SetElementHandler(parser.get(), start, end);
    XML_SetCharacterDataHandler(parser.get(), characters);
    if (XML_Parse(parser.get(), xml.data(), static_cast<int>(xml.size()), 1) != XML_STATUS_OK)
        throw std::runtime_error(std::string(XML_ErrorString(XML_GetErrorCode(parser.get()))) + " in line " +
                                 std::to_string(XML_GetCurrentLineNumber(parser.get())));
    return reading.elements;
}

} // namespace forceshade::testing
