#include "vtkMidSurfaceStatistics.h"

#include "BlockRun.h"
#include "FilterRun.h"
#include "LabelTable.h"
#include "Pieces.h"
#include "ProcessExchange.h"
#include "TriangleInput.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkTypeInt64Array.h"

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

vtkStandardNewMacro(vtkMidSurfaceStatistics);

namespace
{
using Row = midsurface_statistics_row;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

template <typename ArrayType, typename Read>
void AddColumn(vtkTable* table, const char* name, const std::vector<Row>& rows, Read read)
{
  vtkNew<ArrayType> column;
  column->SetName(name);
  column->SetNumberOfValues(static_cast<vtkIdType>(rows.size()));
  vtkIdType index = 0;
  for (const Row& row : rows)
  {
    column->SetValue(index++, read(row));
  }
  table->AddColumn(column);
}

template <typename Read>
void AddNumbers(vtkTable* table, const char* name, const std::vector<Row>& rows, Read read)
{
  AddColumn<vtkDoubleArray>(table, name, rows, read);
}

template <typename Read>
void AddCounts(vtkTable* table, const char* name, const std::vector<Row>& rows, Read read)
{
  AddColumn<vtkTypeInt64Array>(
    table, name, rows, [&read](const Row& row) { return static_cast<vtkTypeInt64>(read(row)); });
}

std::string Describe(const Row& row, const LabelTable& names)
{
  switch (row.scope)
  {
    case MIDSURFACE_SCOPE_TOTAL:
      return "total";
    case MIDSURFACE_SCOPE_LABEL:
      return "label " + LabelTable::Text(*names.Entries().find(row.label));
    default:
      return "component " + std::to_string(row.component);
  }
}

void AddScope(vtkTable* table, const std::vector<Row>& rows, vtkFieldData* fields)
{
  LabelTable names;
  for (const Row& row : rows)
  {
    names.Add(std::array<int64_t, 1>{ row.label });
  }
  names.ReadNames(fields);
  AddColumn<vtkStringArray>(
    table, "Of", rows, [&names](const Row& row) { return Describe(row, names); });
  AddNumbers(table, "Label", rows,
    [](const Row& row) { return row.has_label ? static_cast<double>(row.label) : unknown; });
  AddNumbers(table, "Component", rows, [](const Row& row) {
    return row.scope == MIDSURFACE_SCOPE_COMPONENT ? static_cast<double>(row.component) : unknown;
  });
}

void AddSize(vtkTable* table, const std::vector<Row>& rows)
{
  AddCounts(table, "Points", rows, [](const Row& row) { return row.points; });
  AddCounts(table, "Triangles", rows, [](const Row& row) { return row.triangles; });
  AddNumbers(table, "Area", rows, [](const Row& row) { return row.area; });
  AddCounts(table, "Closed", rows, [](const Row& row) { return row.boundary_loops == 0; });
  AddCounts(table, "EulerNumber", rows, [](const Row& row) { return row.euler_number; });
  AddNumbers(table, "BoundaryLength", rows, [](const Row& row) { return row.boundary_length; });
  AddCounts(table, "BoundaryLoops", rows, [](const Row& row) { return row.boundary_loops; });
}

void AddThickness(vtkTable* table, const std::vector<Row>& rows)
{
  AddNumbers(table, "ThicknessMean", rows, [](const Row& row) { return row.thickness_mean; });
  const char* names[] = { "Thickness5", "Thickness25", "ThicknessMedian", "Thickness75",
    "Thickness95" };
  for (int which = 0; which < 5; ++which)
  {
    AddNumbers(table, names[which], rows,
      [which](const Row& row) { return row.thickness_quantiles[which]; });
  }
}

void AddQuality(vtkTable* table, const std::vector<Row>& rows)
{
  AddNumbers(table, "Qmin", rows, [](const Row& row) { return row.quality_smallest; });
  AddNumbers(table, "Qavg", rows, [](const Row& row) { return row.quality_mean; });
  AddNumbers(
    table, "MeanSmallestAngle", rows, [](const Row& row) { return row.mean_smallest_angle; });
  AddNumbers(table, "ShareUnder30", rows, [](const Row& row) { return row.share_under_30; });
  AddNumbers(table, "ShareOver120", rows, [](const Row& row) { return row.share_over_120; });
  AddNumbers(table, "V567", rows, [](const Row& row) { return row.valence_567; });
}
/** The rows of a mesh, of which `input` may be a piece; none where another process has them. */
std::vector<Row> MeasureAll(const BlockRun& run, vtkInformation* output, vtkPolyData* input)
{
  if (run.HasBlocks() || !Pieces::AreShared(output))
  {
    return Pieces::HasToWork(run, output) ? midsurface::Measure(TriangleInput(input).Mesh())
                                          : std::vector<Row>();
  }
  const ProcessExchange exchange;
  std::optional<TriangleInput> triangles;
  exchange.Guard([&] { triangles.emplace(input); });
  return midsurface::MeasurePieces(triangles->Mesh(), exchange.Functions());
}
} // namespace

//------------------------------------------------------------------------------
vtkMidSurfaceStatistics::vtkMidSurfaceStatistics()
  : Run(std::make_unique<BlockRun>(this))
{}

//------------------------------------------------------------------------------
vtkMidSurfaceStatistics::~vtkMidSurfaceStatistics() = default;

//------------------------------------------------------------------------------
void vtkMidSurfaceStatistics::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

//------------------------------------------------------------------------------
int vtkMidSurfaceStatistics::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
int vtkMidSurfaceStatistics::RequestData(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkPolyData* input = vtkPolyData::GetData(inputVector[0]);
  vtkTable* output = vtkTable::GetData(outputVector);
  vtkInformation* outputInformation = outputVector->GetInformationObject(0);
  const int result = FilterRun::Execute(this, 0, output, [=](FilterRun&) {
    const std::vector<Row> rows = MeasureAll(*this->Run, outputInformation, input);
    if (rows.empty())
    {
      return;
    }
    AddScope(output, rows, input->GetFieldData());
    AddSize(output, rows);
    AddThickness(output, rows);
    AddQuality(output, rows);
  });
  return Pieces::Result(outputInformation, result);
}
