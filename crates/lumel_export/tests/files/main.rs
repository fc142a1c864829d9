//! What other programs and damaged disks make of our files.

#[cfg(test)]
mod damage;
#[cfg(test)]
mod glb;
#[cfg(test)]
mod kept;
#[cfg(test)]
mod lighting;
#[cfg(test)]
mod lightmap;
#[cfg(test)]
mod lightmapped;
#[cfg(test)]
mod npz;
#[cfg(test)]
mod obj;
#[cfg(test)]
mod ply;
#[cfg(test)]
mod rad;
#[cfg(test)]
mod scenes;
#[cfg(test)]
mod solution;
#[cfg(test)]
mod tools;
#[cfg(test)]
mod transparent;
#[cfg(test)]
mod unwrapped;
