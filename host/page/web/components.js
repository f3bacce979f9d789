// The components of a drive: the tables of the rig file that each of them has.

export const COMPONENTS = [
  { id: 'test', title: 'Test move', tables: ['test'] },
  { id: 'controller', title: 'Controller', tables: ['controller', 'safety'] },
  { id: 'operator', title: 'Valve operator', tables: ['operator'] },
  { id: 'valve', title: 'Valve', tables: ['valve'] },
  { id: 'tubing', title: 'Tubes', tables: ['tubing'] },
  { id: 'air', title: 'Air supply', tables: ['supply', 'exhaust', 'gas'] },
  { id: 'cylinder', title: 'Cylinder', tables: ['actuator'] },
  { id: 'load', title: 'Load', tables: ['load'] },
  { id: 'sensing', title: 'Encoder and sensors', tables: ['encoder', 'sensors'] },
  { id: 'faults', title: 'Name and faults', tables: ['', 'faults'] },
];

/** The component that has a key. */
export function componentOf(path) {
  const table = path.includes('.') ? path.split('.')[0] : '';
  return COMPONENTS.find(({ tables }) => tables.includes(table));
}
