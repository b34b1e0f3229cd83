//! Every shader is sound, and holds what the launcher beside it says, without a GPU.
#![cfg(not(target_arch = "wasm32"))]

use std::path::Path;

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, Module, Scalar, TypeInner};

/// Included here because it is private in the crate.
#[path = "../src/device/gpu/params.rs"]
#[allow(dead_code)] // Only the layouts are asked for.
mod params;

/// Name and module of every shader there is.
fn shaders() -> Vec<(String, Module)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/device/gpu");
    let mut shaders = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the folder of the shaders") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "wgsl") {
            continue;
        }
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let source = std::fs::read_to_string(&path).expect("text");
        match naga::front::wgsl::parse_str(&source) {
            Ok(module) => shaders.push((name, module)),
            Err(error) => panic!("{}", error.emit_to_string_with_path(&source, &name)),
        }
    }
    shaders.sort_by(|a, b| a.0.cmp(&b.0));
    assert!(!shaders.is_empty(), "no shaders were found");
    shaders
}

#[test]
fn every_shader_is_valid_without_any_extension() {
    for (name, module) in shaders() {
        let outcome = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
        assert!(outcome.is_ok(), "{name}: {outcome:?}");
        assert!(!module.entry_points.is_empty(), "{name} has nothing to run");
    }
}

#[test]
fn every_shader_stays_within_the_limits_of_any_webgpu_device() {
    for (name, module) in shaders() {
        let in_space = |wanted: fn(&AddressSpace) -> bool| -> Vec<_> {
            module.global_variables.iter().filter(|(_, variable)| wanted(&variable.space)).collect()
        };
        let storage = in_space(|space| matches!(space, AddressSpace::Storage { .. }));
        assert!(storage.len() <= 8, "{name} binds {} storage buffers", storage.len());
        let shared: u32 = in_space(|space| matches!(space, AddressSpace::WorkGroup))
            .iter()
            .map(|(_, variable)| module.types[variable.ty].inner.size(module.to_ctx()))
            .sum();
        assert!(shared <= 16384, "{name} takes {shared} bytes of workgroup memory");
        for entry in &module.entry_points {
            let invocations: u32 = entry.workgroup_size.iter().product();
            assert!(invocations <= 256, "{name}: {} runs {invocations} invocations together", entry.name);
        }
    }
}

#[test]
fn params_lie_in_the_shader_as_in_the_launcher() {
    let shaders = shaders();
    for (name, module) in &shaders {
        let layout = params::LAYOUTS.iter().find(|(shader, _)| shader == name);
        let (_, fields) = layout.unwrap_or_else(|| panic!("{name} has no launcher"));
        let (_, uniform) = module
            .global_variables
            .iter()
            .find(|(_, variable)| variable.space == AddressSpace::Uniform)
            .unwrap_or_else(|| panic!("{name} takes no parameters"));
        let TypeInner::Struct { members, span } = &module.types[uniform.ty].inner else {
            panic!("{name}: parameters are a struct")
        };
        assert_eq!(*span as usize, 4 * fields.len(), "{name}: size of the parameters");
        let in_shader: Vec<(&str, &str)> = members
            .iter()
            .enumerate()
            .map(|(i, member)| {
                assert_eq!(member.offset as usize, 4 * i, "{name}: the launcher leaves no gaps");
                let number = match module.types[member.ty].inner {
                    TypeInner::Scalar(Scalar::U32) => "u32",
                    TypeInner::Scalar(Scalar::F32) => "f32",
                    ref other => panic!("{name}: a parameter is a {other:?}"),
                };
                (member.name.as_deref().unwrap_or(""), number)
            })
            .collect();
        assert_eq!(in_shader, *fields, "{name}: parameters");
    }
    assert_eq!(shaders.len(), params::LAYOUTS.len(), "every launcher has its shader");
}
