// Makes a prefab with a LODGroup beside every lods.json that Parbake has written, as soon as Unity imports it.
// Needs a glTF importer in the project (glTFast or UnityGLTF). Keep this file in a folder named Editor.
// Screen heights are those of lods.json with a LOD bias of 1 and a field of view of 60 degrees.
using System.IO;
using System.Linq;
using UnityEditor;
using UnityEngine;

public class ParbakeLods : AssetPostprocessor
{
    [System.Serializable]
    class Level
    {
        public string file;
        public float min_coverage;
    }

    [System.Serializable]
    class Chain
    {
        public string name;
        public Level[] levels;
    }

    static void OnPostprocessAllAssets(string[] imported, string[] deleted, string[] moved, string[] movedFrom)
    {
        foreach (var path in imported.Where(p => Path.GetFileName(p) == "lods.json"))
        {
            // Models of the same folder may be imported after this file.
            EditorApplication.delayCall += () => Build(path);
        }
    }

    static void Build(string path)
    {
        var chain = JsonUtility.FromJson<Chain>(File.ReadAllText(path));
        var folder = Path.GetDirectoryName(path).Replace('\\', '/');
        var root = new GameObject(chain.name);
        var lods = chain.levels.Select(level =>
        {
            var asset = AssetDatabase.LoadAssetAtPath<GameObject>(folder + "/" + level.file);
            if (asset == null)
            {
                Debug.LogError("Parbake: " + folder + "/" + level.file + " was not imported; is there a glTF importer?");
                return new LOD(level.min_coverage, new Renderer[0]);
            }
            var instance = (GameObject)PrefabUtility.InstantiatePrefab(asset, root.transform);
            return new LOD(level.min_coverage, instance.GetComponentsInChildren<Renderer>());
        }).ToArray();
        root.AddComponent<LODGroup>().SetLODs(lods);
        root.GetComponent<LODGroup>().RecalculateBounds();
        PrefabUtility.SaveAsPrefabAsset(root, folder + "/@NAME@.prefab");
        Object.DestroyImmediate(root);
    }
}
