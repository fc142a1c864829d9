//! Reading pictures back from the device.

use crate::target::Target;
use crate::{Gpu, RenderError, memory::within_memory};
use lumel_render_cpu::Picture;
use std::sync::mpsc;

/// Waits for the device and reads the picture.
pub(crate) fn read(gpu: &Gpu, target: &Target) -> Result<Picture, RenderError> {
    let [width, height] = target.size();
    // Rows start at multiples of 256 bytes.
    let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let bytes = u64::from(row) * u64::from(height);
    let limit = gpu.device().limits().max_buffer_size;
    if bytes > limit {
        return Err(RenderError::Read(format!("it takes {bytes} bytes; the limit is {limit}")));
    }
    let what = format!("a copy of a picture of {width} x {height} pixels");
    let buffer = within_memory(gpu, &what, || copy(gpu, target, row, bytes))?;
    let (sender, receiver) = mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // If polling has failed, nobody is waiting.
        let _ = sender.send(result);
    });
    let failed = |error: &dyn std::fmt::Display| RenderError::Read(error.to_string());
    gpu.device().poll(wgpu::PollType::wait_indefinitely()).map_err(|e| failed(&e))?;
    receiver.recv().map_err(|e| failed(&e))?.map_err(|e| failed(&e))?;
    let mapped = buffer.get_mapped_range(..).map_err(|e| failed(&e))?;
    let rows = mapped.chunks_exact(row as usize);
    let pixels = rows.flat_map(|row| row.as_chunks::<4>().0.iter().take(width as usize));
    let pixels = pixels.map(|&[r, g, b, _]| [r, g, b]).collect();
    Ok(Picture::new(width, height, pixels)?)
}

fn copy(gpu: &Gpu, target: &Target, row: u32, bytes: u64) -> wgpu::Buffer {
    let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
        label: Some("picture"),
        size: bytes,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(target.picture.as_image_copy(), to, target.picture.size());
    gpu.queue().submit([encoder.finish()]);
    buffer
}
