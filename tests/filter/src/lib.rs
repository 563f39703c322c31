//! The real VTK filter, as a C++ library, called from Rust.

/// The functions of `FilterBridge.h`, which tells what they do.
#[cxx::bridge]
#[allow(missing_docs)]
pub mod bridge {
    unsafe extern "C++" {
        include!("FilterBridge.h");

        type FilterBridge;

        #[cxx_name = "MakeFilterBridge"]
        fn filter() -> UniquePtr<FilterBridge>;
        #[cxx_name = "SetFrame"]
        fn set_frame(
            &self,
            extent: &[i32; 6],
            spacing: &[f64; 3],
            origin: &[f64; 3],
            direction: &[f64; 9],
        );
        #[cxx_name = "AddArray"]
        unsafe fn add_array(
            &self,
            vtk_type: i32,
            components: i32,
            bytes: *const u8,
            size: usize,
            on_cells: bool,
        ) -> Result<()>;
        #[cxx_name = "SetMethod"]
        fn set_method(&self, method: i32);
        #[cxx_name = "SetEdgeLength"]
        fn set_edge_length(&self, length: f64);
        #[cxx_name = "SetThreads"]
        fn set_threads(&self, threads: i32);
        #[cxx_name = "SetThreshold"]
        fn set_threshold(&self, threshold: f64);
        #[cxx_name = "ChooseLabel"]
        fn choose_label(&self, label: i64);
        #[cxx_name = "Update"]
        fn update(&self) -> bool;
        #[cxx_name = "GetErrors"]
        fn errors(&self) -> &CxxString;
        #[cxx_name = "GetWarnings"]
        fn warnings(&self) -> &CxxString;
        #[cxx_name = "GetPoints"]
        fn points(&self) -> UniquePtr<CxxVector<f32>>;
        #[cxx_name = "GetTriangles"]
        fn triangles(&self) -> UniquePtr<CxxVector<i64>>;
        #[cxx_name = "GetPointArray"]
        fn point_array(&self, name: &CxxString) -> UniquePtr<CxxVector<f32>>;
        #[cxx_name = "GetCellArray"]
        fn cell_array(&self, name: &CxxString) -> UniquePtr<CxxVector<i64>>;
    }
}
