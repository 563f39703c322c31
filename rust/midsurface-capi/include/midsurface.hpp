/*
 * midsurface.hpp: midsurface.h for C++17, header only. Objects free themselves, failures are
 * thrown as midsurface::Error, callbacks may be anything callable and may throw. Units, shapes,
 * lifetimes and threads are as told in midsurface.h.
 */
#ifndef MIDSURFACE_HPP
#define MIDSURFACE_HPP

#include "midsurface.h"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

namespace midsurface
{

/// Why a call failed; what() is a message for the user.
class Error : public std::runtime_error
{
public:
  Error(midsurface_status status, const char* message)
    : std::runtime_error(message)
    , Status(status)
  {}
  midsurface_status Status;
};

template <auto Free>
struct Deleter
{
  template <typename Object>
  void operator()(Object* object) const noexcept
  {
    Free(object);
  }
};
using LabelList = std::unique_ptr<midsurface_label_list, Deleter<midsurface_label_list_free>>;
using Polylines = std::unique_ptr<midsurface_polylines, Deleter<midsurface_polylines_free>>;
using Mesh = std::unique_ptr<midsurface_mesh, Deleter<midsurface_mesh_free>>;
using Statistics = std::unique_ptr<midsurface_statistics, Deleter<midsurface_statistics_free>>;

/// What a run may be told; the default is right for most.
struct Options
{
  std::uint32_t Method = MIDSURFACE_METHOD_RIDGE_SURFACE;
  std::uint32_t Threads = 0;                         ///< 0: one a core.
  double EdgeLength = 0.0;                           ///< 0: chosen by the finest spacing.
  std::optional<std::vector<std::int64_t>> Labels;   ///< Absent: all; empty: none.
  std::function<bool(double, const char*)> Progress; ///< Fraction and stage; false cancels.
  std::function<void(const char*)> Warning;
};

namespace detail
{
inline void Require(midsurface_status status, midsurface_error* error)
{
  const std::unique_ptr<midsurface_error, Deleter<midsurface_error_free>> owner(error);
  if (status != MIDSURFACE_STATUS_OK)
  {
    throw Error(status, midsurface_error_message(error));
  }
}

/// Makes a call that takes no options.
template <typename Function, typename... Arguments>
void Call(Function function, Arguments... arguments)
{
  midsurface_error* error = nullptr;
  const midsurface_status status = function(arguments..., &error);
  Require(status, error);
}

/// The options as C takes them. What a callback throws waits here until the C code has returned.
class Run
{
public:
  explicit Run(const Options& options)
    : Callbacks(options)
  {
    this->Target.method = options.Method;
    this->Target.threads = options.Threads;
    this->Target.edge_length = options.EdgeLength;
    if (options.Labels)
    {
      // An empty vector's data() may be NULL, which would mean all labels.
      static constexpr std::int64_t none = 0;
      this->Target.labels = options.Labels->empty() ? &none : options.Labels->data();
      this->Target.label_count = options.Labels->size();
    }
    this->Target.progress = [](void* user, double fraction, const char* stage) {
      Run& run = *static_cast<Run*>(user);
      bool proceed = true;
      run.Guard(
        [&] { proceed = !run.Callbacks.Progress || run.Callbacks.Progress(fraction, stage); });
      return proceed && !run.Thrown;
    };
    this->Target.warning = [](void* user, const char* message) {
      Run& run = *static_cast<Run*>(user);
      run.Guard([&] { run.Callbacks.Warning ? run.Callbacks.Warning(message) : void(); });
    };
    this->Target.user = this;
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  const midsurface_options* Get() const { return &this->Target; }

  void Finish(midsurface_status status, midsurface_error* error)
  {
    if (this->Thrown)
    {
      midsurface_error_free(error);
      std::rethrow_exception(this->Thrown);
    }
    Require(status, error);
  }

private:
  template <typename Callback>
  void Guard(Callback callback) noexcept
  {
    try
    {
      callback();
    }
    catch (...)
    {
      this->Thrown = std::current_exception();
    }
  }

  const Options& Callbacks;
  midsurface_options Target = midsurface_options_default();
  std::exception_ptr Thrown;
};

template <typename Handle, typename Function, typename Input>
Handle Make(Function function, const Input* input, const Options& options)
{
  Run run(options);
  typename Handle::pointer object = nullptr;
  midsurface_error* error = nullptr;
  const midsurface_status status = function(input, run.Get(), &object, &error);
  Handle handle(object);
  run.Finish(status, error);
  return handle;
}
} // namespace detail

/// The labels of a volume, ascending; the background, 0, is none.
inline std::vector<std::int64_t> FindLabels(
  const midsurface_volume& volume, const Options& options = {})
{
  const auto list = detail::Make<LabelList>(midsurface_find_labels, &volume, options);
  const std::int64_t* values = midsurface_label_list_values(list.get());
  return { values, values + midsurface_label_list_length(list.get()) };
}

inline Mesh Extract(const midsurface_volume& volume, const Options& options = {})
{
  return detail::Make<Mesh>(midsurface_extract, &volume, options);
}

namespace detail
{
/// Makes a call that processes make together; `Function` takes the exchange after the input.
template <typename Handle, typename Function, typename Input>
Handle MakeTogether(Function function, const Input* input, const midsurface_exchange& exchange,
  const Options& options)
{
  const auto together = [&](const Input* own, const midsurface_options* run,
                          typename Handle::pointer* out, midsurface_error** error) {
    return function(own, &exchange, run, out, error);
  };
  return Make<Handle>(together, input, options);
}
} // namespace detail

/// The components of this process, of a volume that many hold in pieces.
inline Mesh ExtractPiece(
  const midsurface_piece& piece, const midsurface_exchange& exchange, const Options& options = {})
{
  return detail::MakeTogether<Mesh>(midsurface_extract_piece, &piece, exchange, options);
}

/// Tells the other processes that this one does not make the call that they make, and why.
inline void Abandon(const midsurface_exchange& exchange, const char* message)
{
  detail::Call(midsurface_abandon, &exchange, message);
}

inline Polylines ExtractPolylines(const midsurface_volume& volume, const Options& options = {})
{
  return detail::Make<Polylines>(midsurface_extract_polylines, &volume, options);
}

/// Those of this process's components, of a volume that many hold in pieces.
inline Polylines ExtractPolylinesPiece(
  const midsurface_piece& piece, const midsurface_exchange& exchange, const Options& options = {})
{
  return detail::MakeTogether<Polylines>(
    midsurface_extract_polylines_piece, &piece, exchange, options);
}

inline Mesh Zip(const Polylines& polylines, const Options& options = {})
{
  return detail::Make<Mesh>(midsurface_zip, polylines.get(), options);
}

/// The mesh of this process's lines, where many have those of whole components each.
inline Mesh ZipPiece(
  const Polylines& polylines, const midsurface_exchange& exchange, const Options& options = {})
{
  return detail::MakeTogether<Mesh>(midsurface_zip_piece, polylines.get(), exchange, options);
}

/// Fills the caller's arrays, of `length` floats each.
inline void RidgeField(const midsurface_volume& volume, float* distance, float* ridge,
  std::size_t length, const Options& options = {})
{
  detail::Run run(options);
  midsurface_error* error = nullptr;
  const midsurface_status status =
    midsurface_ridge_field(&volume, run.Get(), distance, ridge, length, &error);
  run.Finish(status, error);
}

/// The same for the piece that this process holds.
inline void RidgeFieldPiece(const midsurface_piece& piece, const midsurface_exchange& exchange,
  float* distance, float* ridge, std::size_t length, const Options& options = {})
{
  detail::Run run(options);
  midsurface_error* error = nullptr;
  const midsurface_status status =
    midsurface_ridge_field_piece(&piece, &exchange, run.Get(), distance, ridge, length, &error);
  run.Finish(status, error);
}

namespace detail
{
inline std::vector<midsurface_statistics_row> Rows(const Statistics& table)
{
  const midsurface_statistics_row* rows = midsurface_statistics_rows(table.get());
  return { rows, rows + midsurface_statistics_length(table.get()) };
}
} // namespace detail

/// The table of a mesh's figures.
inline std::vector<midsurface_statistics_row> Measure(const midsurface_triangle_mesh& mesh)
{
  midsurface_statistics* table = nullptr;
  detail::Call(midsurface_measure, &mesh, &table);
  return detail::Rows(Statistics(table));
}

/// The table of a mesh that many processes hold, for the first of them; none for the others.
inline std::vector<midsurface_statistics_row> MeasurePieces(
  const midsurface_triangle_mesh& mesh, const midsurface_exchange& exchange)
{
  midsurface_statistics* table = nullptr;
  detail::Call(midsurface_measure_pieces, &mesh, &exchange, &table);
  return detail::Rows(Statistics(table));
}

/// Copies arrays into polylines.
inline Polylines MakePolylines(const midsurface_polyline_arrays& arrays)
{
  midsurface_polylines* polylines = nullptr;
  detail::Call(midsurface_polylines_new, &arrays, &polylines);
  return Polylines(polylines);
}

/// The arrays of polylines; they end with them.
inline midsurface_polyline_arrays Arrays(const Polylines& polylines)
{
  midsurface_polyline_arrays arrays;
  detail::Call(midsurface_polylines_arrays, polylines.get(), &arrays);
  return arrays;
}

/// The arrays of a mesh; they end with it.
inline midsurface_mesh_arrays Arrays(const Mesh& mesh)
{
  midsurface_mesh_arrays arrays;
  detail::Call(midsurface_mesh_view, mesh.get(), &arrays);
  return arrays;
}

} // namespace midsurface

#endif
