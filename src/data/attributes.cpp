#include "shapelight/data/attributes.hpp"

#include <algorithm>
#include <array>

namespace shapelight {
namespace {

struct TypeInfo {
  std::string_view name;
  std::size_t size;
};
constexpr std::array<TypeInfo, 10> kTypes = {{{"int8", 1},
                                              {"uint8", 1},
                                              {"int16", 2},
                                              {"uint16", 2},
                                              {"int32", 4},
                                              {"uint32", 4},
                                              {"int64", 8},
                                              {"uint64", 8},
                                              {"float32", 4},
                                              {"float64", 8}}};

template <std::size_t I = 0>
Column::Values zeros(std::size_t type, std::size_t count) {
  if constexpr (I < std::variant_size_v<Column::Values>) {
    if (type == I) return Column::Values(std::in_place_index<I>, count);
    return zeros<I + 1>(type, count);
  } else {
    return {};
  }
}

}  // namespace

std::string_view scalar_type_name(ScalarType type) { return kTypes[static_cast<std::size_t>(type)].name; }
std::size_t scalar_type_size(ScalarType type) { return kTypes[static_cast<std::size_t>(type)].size; }

std::size_t Column::size() const {
  return std::visit([](const auto& v) { return v.size(); }, values);
}

double Column::as_double(std::size_t i) const {
  return std::visit([i](const auto& v) { return static_cast<double>(v[i]); }, values);
}

std::vector<double> Column::to_doubles() const {
  return std::visit([](const auto& v) { return std::vector<double>(v.begin(), v.end()); }, values);
}

Column Column::gather(std::span<const Index> indices) const {
  return std::visit(
      [&]<class T>(const std::vector<T>& v) {
        std::vector<T> chosen(indices.size());
        std::transform(indices.begin(), indices.end(), chosen.begin(), [&](Index i) { return v[i]; });
        return Column{name, std::move(chosen)};
      },
      values);
}

Column make_column(std::string name, ScalarType type, std::size_t count) {
  return {std::move(name), zeros(static_cast<std::size_t>(type), count)};
}

const Column* AttributeTable::find(std::string_view name) const {
  const auto found = std::find_if(columns_.begin(), columns_.end(), [&](const Column& c) { return c.name == name; });
  return found == columns_.end() ? nullptr : &*found;
}

Column* AttributeTable::find(std::string_view name) {
  return const_cast<Column*>(static_cast<const AttributeTable*>(this)->find(name));
}

void AttributeTable::set(Column column) {
  if (Column* existing = find(column.name)) {
    *existing = std::move(column);
  } else {
    columns_.push_back(std::move(column));
  }
}

void AttributeTable::set(AttributeTable columns) {
  for (Column& column : columns.columns_) set(std::move(column));
}

bool AttributeTable::remove(std::string_view name) {
  return std::erase_if(columns_, [&](const Column& c) { return c.name == name; }) > 0;
}

AttributeTable AttributeTable::gather(std::span<const Index> indices) const {
  AttributeTable chosen;
  chosen.columns_.reserve(columns_.size());
  for (const Column& column : columns_) chosen.columns_.push_back(column.gather(indices));
  return chosen;
}

}  // namespace shapelight
