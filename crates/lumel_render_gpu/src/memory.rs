//! Memory of the device.

use crate::{Gpu, RenderError};
use pollster::block_on;

/// Creates something on the device; an error says if there is no memory for it.
///
/// # Errors
/// [`RenderError::OutOfMemory`] with `what`.
pub(crate) fn within_memory<T>(gpu: &Gpu, what: &str, make: impl FnOnce() -> T) -> Result<T, RenderError> {
    // An object that could not be created causes validation errors wherever it is used.
    let validation = gpu.device().push_error_scope(wgpu::ErrorFilter::Validation);
    let memory = gpu.device().push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let made = make();
    let errors = [block_on(memory.pop()), block_on(validation.pop())];
    if errors.iter().any(Option::is_some) {
        return Err(RenderError::OutOfMemory { what: what.to_owned() });
    }
    Ok(made)
}

/// A buffer that holds these bytes; never of size zero.
pub(crate) fn buffer(gpu: &Gpu, label: &str, usage: wgpu::BufferUsages, bytes: &[u8]) -> wgpu::Buffer {
    let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: (bytes.len() as u64)
            .next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT)
            .max(wgpu::COPY_BUFFER_ALIGNMENT),
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    if !bytes.is_empty() {
        gpu.queue().write_buffer(&buffer, 0, bytes);
    }
    buffer
}
